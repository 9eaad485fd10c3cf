"""Figure of a continuation study: the bifurcation diagram, one panel for each amplitude or variable that tells branches apart."""
import numpy as np

from figures_branches import amplitude_columns, bifurcation_panel, drawable, write_tags
from figures_common import (CYCLE, Page, SYMBOLS, label, parameter_of, special_keys, special_points, stability_keys, study_words)

PANELS = 3


def figures(result):
    names = drawable(result)
    columns = panel_columns(result, names) if names else []
    return [("branches", diagram(result, names, columns))] if columns else []


def panel_columns(result, names):
    """Amplitudes named in the study first; a column that is flat on every branch shows nothing."""
    branches = [result.group("branches").group(n) for n in names]
    x = parameter_of(result, branches[0])
    candidates = [c for c in amplitude_columns(branches[0]) if c != x]
    more = [c for c in branches[0].columns if branches[0].descriptions.get(c, "") == "variable" and c not in candidates]
    moving = [c for c in candidates + more if max(np.ptp(b.column(c)) for b in branches) > 1e-9]
    sums = [c for c in moving if "root of the sum" in branches[0].descriptions.get(c, "")]
    return (sums or moving or candidates)[:PANELS]


def diagram(result, names, columns):
    first = result.group("branches").group(names[0])
    x = parameter_of(result, first)
    colours = {name: CYCLE[i % len(CYCLE)] for i, name in enumerate(names)}
    points = special_points(result, [x, *columns])
    keys = stability_keys([result.group("branches").group(n) for n in names]) + special_keys(points)
    page = Page(7.0, 2.5 * len(columns) + 0.8, f"Bifurcation diagram in {SYMBOLS.get(x, x)}, continuation study",
                [study_words(result, words(result, names))], keys)
    panels = page.subplots(len(columns), 1, sharex=True)[:, 0]
    for axes, column in zip(panels, columns):
        bifurcation_panel(axes, result, names, x, column, points, colours.get)
        axes.set_ylabel(label(SYMBOLS.get(column, column), first.units[column]))
    panels[-1].set_xlabel(label(SYMBOLS.get(x, x), first.units[x]))
    page.finish()
    for axes, column in zip(panels, columns):
        write_tags(axes, result, names, x, column, points, colours.get)
    return page.figure


def words(result, names):
    isolas = [n for n in names if float(result.group("branches").group(n).attributes.get("isola", 0)) > 0]
    text = f"{len(names)} branch{'es' if len(names) > 1 else ''}"
    return text + (f" ({', '.join(isolas)} isola{'s' if len(isolas) > 1 else ''})" if isolas else "")
