"""Figure of a two-parameter result: curves of whirling points, folds and Hopf points in the plane of two parameters, with their
codimension-2 points and the threshold, the least second parameter at which whirling starts."""
from dataclasses import dataclass

import numpy as np

from figures_common import (BLUE, DASHES, GREEN, GREY, INK, PURPLE, SYMBOLS, VERMILLION, Page, Tag, damping_words, label, letter,
                            line_key, marker_key, number, parameter_of, place_tags, study_words)
from result_file import Group

DOTS, DASH_DOTS = (0, (1.0, 1.3)), (0, (6.0, 1.6, 1.2, 1.6))
# Colour, line and words of each curve. Where the pair is given, the first line is supercritical, the second subcritical.
CURVES = {
    "WH": (BLUE, ("-", DOTS), "WH whirling points"),
    "BP": (PURPLE, ("-", DOTS), "BP branch points"),
    "LP": (VERMILLION, DASHES, "LP folds"),
    "HB": (GREEN, DASH_DOTS, "HB Hopf points"),
}
# Shape, size and words of each point. Of several at one place the first in this order is drawn: a fold curve of whirling motions
# turns back at the degenerate pitchfork and calls it a cusp, and at a cusp every parameter is extreme.
POINTS = {
    "DP": ("D", 5.0, "DP degenerate pitchfork"), "BT": ("s", 5.2, "BT Bogdanov–Takens"), "ZH": ("X", 6.5, "ZH zero-Hopf"),
    "GH": ("h", 6.5, "GH generalised Hopf"), "CP": ("*", 8.5, "CP cusp"), "threshold": ("o", 5.5, "threshold of whirling"),
    "MIN": ("v", 3.6, "minimum"), "MAX": ("^", 3.6, "maximum"),
}
QUIET = ("MIN", "MAX")      # marked, not named
WINDOW = (0.085, 0.055)     # half sizes of the panel about the threshold, in ranges of the two parameters


@dataclass
class Curve:
    name: str
    kind: str               # key of CURVES
    xy: np.ndarray          # one row per drawn point
    coefficient: np.ndarray

    @property
    def colour(self):
        return CURVES[self.kind][0]

    def pieces(self):
        """(line style, first, last): one piece, or one per sign of the coefficient, neighbours sharing a point."""
        styles = CURVES[self.kind][1]
        if styles == DASHES or styles == DASH_DOTS:
            yield styles, 0, len(self.xy) - 1
            return
        # A stretch is subcritical by its larger end: the one at the degenerate pitchfork is zero.
        subcritical = self.coefficient[:-1] + self.coefficient[1:] > 0
        first = 0
        for i in range(1, len(subcritical) + 1):
            if i == len(subcritical) or subcritical[i] != subcritical[first]:
                yield styles[int(subcritical[first])], first, i
                first = i


@dataclass
class Point:
    kind: str               # key of POINTS
    curve: str
    place: np.ndarray

    def name(self, points):
        shared = sum(p.kind == self.kind for p in points) > 1
        return f"{self.kind} ({self.curve})" if shared else self.kind


def figures(result):
    names = [name for name, table in result.group("curves").groups.items() if table.rows() >= 2]
    if not names:
        return []
    first = result.group("curves").group(names[0])
    x = parameter_of(result, first)
    y = str(result.group("study").attributes.get("second.parameter", list(first.columns)[1]))
    scale = np.array([span(result, "continuation.range", names, x), span(result, "second.range", names, y)])
    points = points_of(result, x, y, scale)
    curves = [curve_of(result, name, x, y, scale, points) for name in names]
    curves.sort(key=lambda c: list(CURVES).index(c.kind))
    return [("chart", chart(result, curves, points, (x, y), [first.units.get(c, "") for c in (x, y)], scale))]


# --- reading ---------------------------------------------------------------------------------------------------------------

def span(result, key, names, column):
    """Width of a parameter's range, or of what the curves cover when the file does not say."""
    limits = np.asarray(result.group("study").attributes.get(key, []), dtype=float)
    if limits.shape != (2,):
        limits = np.concatenate([result.group("curves").group(n).column(column) for n in names])
    return float(np.ptp(limits)) or 1.0


def kind_of(table):
    kind, subtype = str(table.attributes.get("type", "")), str(table.attributes.get("subtype", ""))
    return subtype if subtype in CURVES else kind if kind in CURVES else "BP"


def points_of(result, x, y, scale):
    """Special points, a place once; the least of the whirling curves' minima is the threshold."""
    table = result.group("special_points")
    found = [Point(str(table.column("type")[i]), str(table.column("curve")[i]), np.array([table.column(x)[i], table.column(y)[i]]))
             for i in range(table.rows())]
    found = [p for p in found if p.kind in POINTS]
    lowest = [p for p in found if p.kind == "MIN" and kind_of(result.group("curves").group(p.curve)) == "WH"]
    if lowest:
        min(lowest, key=lambda p: p.place[1]).kind = "threshold"
    points = []
    for p in sorted(found, key=lambda p: list(POINTS).index(p.kind)):
        if all(np.max(np.abs(p.place - q.place) / scale) > 1e-6 for q in points):
            points.append(p)
    return points


def curve_of(result, name, x, y, scale, points):
    table = result.group("curves").group(name)
    xy, coefficient = np.column_stack([table.column(x), table.column(y)]), np.array(table.column("coefficient"), dtype=float)
    amplitudes = [table.columns[c] for c in table.columns if c.startswith("q") and "_h" in c]
    state = np.column_stack([xy / scale, *(a / (np.max(np.abs(a)) or 1.0) for a in amplitudes)])
    for p in points:
        if p.kind not in ("CP", "DP"):
            continue
        turn = crossing(xy / scale, coefficient, p.place / scale)
        if turn is None:
            continue
        halves = (slice(0, turn), slice(turn, len(xy)))
        longer = max(halves, key=lambda h: h.stop - h.start)
        xy, coefficient, state = (np.insert(a, turn, v, axis=0) for a, v in
                                  ((xy, p.place), (coefficient, 0.0), (state, 0.5 * (state[turn - 1] + state[turn]))))
        if len(amplitudes) and retraced(state, turn):
            keep = slice(0, turn + 1) if longer.start == 0 else slice(turn, len(xy))
            xy, coefficient, state = xy[keep], coefficient[keep], state[keep]
    return Curve(name, kind_of(table), xy, coefficient)


def crossing(xy, coefficient, place):
    """Row before which a point where the coefficient vanishes belongs, or None when it lies on another curve."""
    signs = np.flatnonzero(coefficient[:-1] * coefficient[1:] < 0)
    if not len(signs):
        return None
    apart = [min(np.hypot(*(xy[i] - place)), np.hypot(*(xy[i + 1] - place))) for i in signs]
    best = signs[int(np.argmin(apart))]
    step = np.hypot(*(xy[best + 1] - xy[best]))
    return int(best) + 1 if np.min(apart) < 3 * step + 1e-3 else None


def retraced(state, turn):
    """Does the curve run back over itself, as the mirror image of what it was? Drawn twice, dashes would fill up."""
    one, two = state[:turn + 1], state[turn:]
    short, long = (one, two) if len(one) < len(two) else (two, one)
    if len(short) < 3:
        return False
    a, b = long[:-1], long[1:] - long[:-1]
    share = np.sum((short[:, None] - a) * b, axis=-1) / np.maximum(np.sum(b * b, axis=-1), 1e-30)
    apart = np.linalg.norm(short[:, None] - a - np.clip(share, 0, 1)[..., None] * b, axis=-1).min(axis=1)
    # The mirror image may have been followed a little farther than the original.
    return np.mean(apart < 5e-3) > 0.9


# --- drawing ---------------------------------------------------------------------------------------------------------------

def chart(result, curves, points, parameters, units, scale):
    words = f"{len(curves)} curve{'s' if len(curves) > 1 else ''}"
    threshold = next((p for p in points if p.kind == "threshold"), None)
    study_value = result.group("study").attributes.get(parameters[1])
    symbols = [SYMBOLS.get(p, p) for p in parameters]
    limits = outer_limits(curves, points, study_value, scale)
    shown = [p for p in points if inside(p.place, limits)]
    keys = chart_keys(curves, shown, symbols[1], units[1], study_value)
    page = Page(7.0, 4.6 + (2.9 if threshold else 0), title(curves, symbols), [study_sentence(result, words, parameters)], keys)
    panels = page.subplots(2 if threshold else 1, 1, height_ratios=[1.6, 1.0] if threshold else [1])[:, 0]
    views = [limits]
    if threshold:
        views.append(np.column_stack([threshold.place - np.array(WINDOW) * scale, threshold.place + np.array(WINDOW) * scale]))
    for k, (axes, view) in enumerate(zip(panels, views)):
        draw_plane(axes, curves, shown, view, study_value)
        axes.set_xlabel(label(symbols[0], units[0]))
        axes.set_ylabel(label(symbols[1], units[1]))
        if threshold:
            axes.set_title(f"{letter(k)} {('all curves', 'about the threshold: the frame in (a)')[k]}", loc="left")
    if threshold:
        draw_frame(panels[0], views[1])
    page.finish()
    for k, (axes, view) in enumerate(zip(panels, views)):
        write_names(axes, curves, shown, view, threshold_words(threshold, symbols, units), views[1] if threshold and k == 0 else None)
    return page.figure


def title(curves, symbols):
    nouns = {"WH": "whirling", "BP": "branch", "LP": "fold", "HB": "Hopf"}
    words = [nouns[k] for k in CURVES if any(c.kind == k for c in curves)]
    joined = " and ".join(filter(None, (", ".join(words[:-1]), words[-1])))
    return f"{joined[0].upper()}{joined[1:]} points in the plane of {symbols[0]} and {symbols[1]}, two-parameter study"


def study_sentence(result, words, parameters):
    """What is fixed; both parameters of the plane are left out."""
    a = result.group("study").attributes
    fixed = {key: value for key, value in a.items() if key not in parameters}
    sentence = study_words(Group("/", groups={"study": Group("/study", fixed)}), words)
    for key, symbol in (("damping.out_of_plane", r"$\zeta_1$"), ("damping.in_plane", r"$\zeta_2$")):
        if key in fixed and damping_words(0, 0)[:5] not in sentence and any(p.startswith("damping") for p in parameters):
            sentence += f", {symbol} = {fixed[key]:g}"
    return sentence


def outer_limits(curves, points, study_value, scale):
    """What is drawn with a margin, but not beyond where the curves were followed."""
    everything = np.concatenate([c.xy for c in curves] + [p.place[None] for p in points])
    low, high = np.nanmin(everything, axis=0), np.nanmax(everything, axis=0)
    if study_value is not None:
        low[1], high[1] = min(low[1], study_value), max(high[1], study_value)
    return np.column_stack([low - 0.05 * np.minimum(high - low, scale), high + 0.02 * np.minimum(high - low, scale)])


def inside(place, view):
    return bool(np.all((place >= view[:, 0]) & (place <= view[:, 1])))


def draw_plane(axes, curves, points, view, study_value):
    axes.set_xlim(*view[0])
    axes.set_ylim(*view[1])
    axes.grid(True, color="#ececec", linewidth=0.6)
    axes.set_axisbelow(True)
    if study_value is not None:
        axes.plot(view[0], [study_value, study_value], color=GREY, linewidth=0.8, zorder=2)
    for c in curves:
        for style, first, last in c.pieces():
            axes.plot(*c.xy[first:last + 1].T, color=c.colour, linewidth=2.0 if style == DOTS else 1.6, linestyle=style, zorder=3)
    for p in points:
        if inside(p.place, view):
            marker, size, _ = POINTS[p.kind]
            axes.plot(*p.place, zorder=5 if p.kind in QUIET else 6, **marker_style(p.kind), marker=marker, markersize=size)


def marker_style(kind):
    face = {"threshold": INK, "MIN": GREY, "MAX": GREY}.get(kind, "white")
    return {"linestyle": "none", "markerfacecolor": face, "markeredgecolor": GREY if kind in QUIET else INK, "markeredgewidth": 1.1}


def draw_frame(axes, view):
    (x0, x1), (y0, y1) = view
    axes.plot([x0, x1, x1, x0, x0], [y0, y0, y1, y1, y0], color=GREY, linewidth=0.6, zorder=2)


def chart_keys(curves, points, symbol, unit, study_value):
    keys = []
    for kind, (colour, style, words) in CURVES.items():
        drawn = {s for c in curves if c.kind == kind for s, _, _ in c.pieces()}
        for s in (style if style not in (DASHES, DASH_DOTS) else (style,)):
            if s in drawn:
                which = {"-": ", supercritical", DOTS: ", subcritical"}.get(s, "")
                keys.append(line_key(words + which, color=colour, linewidth=2.0 if s == DOTS else 1.6, linestyle=s))
    for kind, (marker, size, words) in POINTS.items():
        if any(p.kind == kind for p in points):
            words = f"{words} of {symbol} on a curve" if kind in QUIET else words
            style = {k: v for k, v in marker_style(kind).items() if k != "linestyle"}
            keys.append(marker_key(words, marker, markersize=size, **style))
    if study_value is not None:
        keys.append(line_key(f"{symbol} = {study_value:g} {'' if unit == '-' else unit}".strip() + " in this study", color=GREY, linewidth=0.8))
    return keys


def threshold_words(threshold, symbols, units):
    if threshold is None:
        return ""
    lines = [f"{symbols[i]} = {number(threshold.place[i], 6)} {'' if units[i] == '-' else units[i]}".strip() for i in (1, 0)]
    return "\n".join(["threshold", *lines])


def write_names(axes, curves, points, view, threshold_text, frame):
    """Names of curves and points in one panel; those inside the frame wait for the panel that enlarges it."""
    tags = []
    for p in points:
        if p.kind in QUIET or not inside(p.place, view):
            continue
        if p.kind == "threshold":
            tags.append(Tag(threshold_text, [tuple(p.place)], INK))
        elif frame is None or not inside(p.place, frame):
            tags.append(Tag(p.name(points), [tuple(p.place)], INK))
    for c in curves:
        places = places_along(c.xy, view, frame)
        if places:
            tags.append(Tag(c.name, places, c.colour, bold=True, leader=False))
    place_tags(axes, tags)


def places_along(xy, view, frame, most=16):
    """Evenly spaced places of a curve within the view, away from its ends and outside the frame."""
    size = view[:, 1] - view[:, 0]
    steps = np.concatenate([[0], np.cumsum(np.hypot(*(np.diff(xy, axis=0) / size).T))])
    at = np.arange(0, steps[-1], 0.01)
    dense = np.column_stack([np.interp(at, steps, xy[:, i]) for i in (0, 1)])
    margin = np.column_stack([view[:, 0] + 0.06 * size, view[:, 1] - 0.06 * size])
    good = [p for p in dense if inside(p, margin) and (frame is None or not inside(p, frame))]
    return [tuple(good[i]) for i in np.unique(np.linspace(0.05 * len(good), 0.95 * len(good) - 1, most).astype(int))] if good else []
