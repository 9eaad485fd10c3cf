"""What the figures of hanging cables share: the cable's line at scale, tables in order of mode or height, words about the cable."""
import numpy as np

from figures_common import NB, number



def in_order(group, prefix):
    """(number, name) of the subgroups prefix<number>, by number."""
    found = []
    for name in group.groups:
        try:
            found.append((float(name[len(prefix):]), name))
        except ValueError:
            continue
    return sorted(found)


def cable_words(result):
    """Span, height, sag and flexibility of the study's cable."""
    c = result.group("cable").columns
    words = [f"span {number(scalar(c, 'span'), 4)}{NB}m", f"height difference {number(scalar(c, 'height_difference'), 4)}{NB}m",
             f"length {number(scalar(c, 'length'), 4)}{NB}m", rf"$b/\sqrt{{l^2-h^2}}$ = {number(scalar(c, 'sag_parameter'), 4)}"]
    kappa = scalar(c, "flexibility")
    words.append(rf"$\kappa$ = $H/EA$ = {number(kappa, 3)}" if kappa > 0 else "inextensible")
    return ", ".join(w.replace(" ", NB) for w in words)


def scalar(columns, name):
    return float(np.ravel(columns[name])[0])


def sentence(result, words):
    return words if result.group("study").attributes.get("outcome") == "complete" else f"{words.rstrip('.')}. Partial result."


def nonzero(*columns):
    """Something in them is worth a panel."""
    return any(np.any(np.abs(c) > 0) for c in columns)


def moved(table, columns, scale):
    """The cable's line displaced by scale times two columns, tangential and normal: x, y in metres."""
    return displaced(table, *(table.column(c) for c in columns), scale)


def displaced(table, U, V, scale):
    x, y = table.column("x"), table.column("y")
    dx, dy = np.gradient(x), np.gradient(y)
    cosine, sine = dx / np.hypot(dx, dy), dy / np.hypot(dx, dy)
    return x + scale * (U * cosine - V * sine), y + scale * (U * sine + V * cosine)
