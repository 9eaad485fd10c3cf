"""Figure of a two-parameter result: curves of whirling points, folds and Hopf points in the plane of two parameters, with their
codimension-2 points and the threshold, the least second parameter at which whirling starts."""
from dataclasses import dataclass

import numpy as np

from figures_common import (BLUE, DASHES, GREEN, GREY, INK, ORANGE, PURPLE, SYMBOLS, VERMILLION, Page, Tag, label, letter, model_parameters,
                            line_key, marker_key, number, parameter_of, place_tags, study_words)
from result_file import Group

DOTS = (0, (1.0, 1.3))
# Of each line: what the plot is told. A Hopf curve may run along a fold curve over most of the plane: it is a band underneath.
LINES = {
    "solid": {"linestyle": "-", "linewidth": 1.6, "zorder": 3}, "dotted": {"linestyle": DOTS, "linewidth": 2.0, "zorder": 3},
    "dashed": {"linestyle": DASHES, "linewidth": 1.6, "zorder": 3},
    "band": {"linestyle": "-", "linewidth": 5.0, "zorder": 2.4, "alpha": 0.4},
}
# Colour, lines and words of each curve. Of two lines the first is supercritical, the second subcritical.
CURVES = {
    "WH": (BLUE, ("solid", "dotted"), "WH whirling points"),
    "BP": (PURPLE, ("solid", "dotted"), "BP branch points"),
    "LP": (VERMILLION, ("dashed",), "LP folds"),
    "HB": (GREEN, ("band",), "HB Hopf points"),
    "RP": (ORANGE, ("solid",), "RP resonance peaks"),
    "PD": (PURPLE, ("solid", "dotted"), "PD period doublings"),
    "SB": (GREY, ("solid", "dotted"), "SB half-period symmetry breaking"),
    "TR": (GREEN, ("dashed",), "TR torus points"),
}
# Shape, size and words of each point. Of several at one place the first in this order is drawn: at a cusp every parameter is
# extreme, too.
POINTS = {
    "DP": ("D", 5.0, "DP degenerate pitchfork"), "BT": ("s", 5.2, "BT Bogdanov–Takens"), "ZH": ("X", 6.5, "ZH zero-Hopf"),
    "R1": ("s", 5.2, "R1 resonance 1:1"), "R2": ("s", 5.2, "R2 resonance 1:2"), "R3": ("h", 6.0, "R3 resonance 1:3"),
    "R4": ("p", 6.0, "R4 resonance 1:4"), "GH": ("h", 6.5, "GH generalised Hopf"),
    "FT": ("d", 6.0, "FT folds touch transcritical points"), "FP": ("P", 6.5, "FP fold and pitchfork"), "PP": ("P", 6.5, "PP two pitchforks"), "HH": ("8", 6.5, "HH double Hopf"), "CP": ("*", 8.5, "CP cusp"), "threshold": ("o", 5.5, "threshold of whirling"),
    "UZ": (".", 4.0, "values asked for"), "MIN": ("v", 3.6, "minimum"), "MAX": ("^", 3.6, "maximum"),
}
QUIET = ("UZ", "MIN", "MAX")      # marked, not named
WINDOW = np.array([[-0.06, 0.085], [-0.05, 0.055]])  # panel about the threshold, in ranges of the two parameters


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
        """(key of LINES, first, last): one piece, or one per sign of the coefficient, neighbours sharing a point."""
        lines = CURVES[self.kind][1]
        if len(lines) == 1:
            yield lines[0], 0, len(self.xy) - 1
            return
        # A stretch is subcritical by its larger end: the one at the degenerate pitchfork is zero.
        subcritical = self.coefficient[:-1] + self.coefficient[1:] > 0
        first = 0
        for i in range(1, len(subcritical) + 1):
            if i == len(subcritical) or subcritical[i] != subcritical[first]:
                yield lines[int(subcritical[first])], first, i
                first = i


@dataclass
class Point:
    kind: str               # key of POINTS
    curve: str
    place: np.ndarray
    curves: set             # all that the file has it on

    def name(self, points):
        shared = sum(p.kind == self.kind for p in points) > 1
        return f"{self.kind} ({self.curve})" if shared else self.kind


def figures(result):
    names = [name for name, table in result.group("curves").groups.items() if table.rows() >= 2]
    if not names:
        return []
    first = result.group("curves").group(names[0])
    own = str(result.group("study").attributes.get("first.parameter", ""))  # of the chart, if it leaves the branches' parameter
    x = own if own in first.columns else parameter_of(result, first)
    y = str(result.group("study").attributes.get("second.parameter", list(first.columns)[1]))
    scale = np.array([span(result, "first.range" if x == own else "continuation.range", names, x), span(result, "second.range", names, y)])
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
    table = result.group("curve_points") or result.group("special_points")
    found = [Point(str(table.column("type")[i]), str(table.column("curve")[i]), np.array([table.column(x)[i], table.column(y)[i]]),
                   {str(table.column("curve")[i])}) for i in range(table.rows())]
    found = [p for p in found if p.kind in POINTS]
    lowest = [p for p in found if p.kind == "MIN" and kind_of(result.group("curves").group(p.curve)) == "WH"]
    if lowest:
        min(lowest, key=lambda p: p.place[1]).kind = "threshold"
    points = []
    for p in sorted(found, key=lambda p: list(POINTS).index(p.kind)):
        same = next((q for q in points if np.max(np.abs(p.place - q.place) / scale) <= 1e-6), None)
        if same:
            same.curves |= p.curves
        else:
            points.append(p)
    return points


def curve_of(result, name, x, y, scale, points):
    """A curve with its cusps and degenerate points sewn in."""
    table = result.group("curves").group(name)
    xy, coefficient = np.column_stack([table.column(x), table.column(y)]), np.array(table.column("coefficient"), dtype=float)
    for p in points:
        row = crossing(xy / scale, coefficient, p.place / scale) if p.kind in ("CP", "DP") and name in p.curves else None
        if row is not None:
            xy, coefficient = np.insert(xy, row, p.place, axis=0), np.insert(coefficient, row, 0.0)
    return Curve(name, kind_of(table), xy, coefficient)


def crossing(xy, coefficient, place):
    """Row before which a point where the coefficient vanishes belongs, or None when the rows do not show it."""
    signs = np.flatnonzero(coefficient[:-1] * coefficient[1:] < 0)
    if not len(signs):
        return None
    apart = [min(np.hypot(*(xy[i] - place)), np.hypot(*(xy[i + 1] - place))) for i in signs]
    best = signs[int(np.argmin(apart))]
    step = np.hypot(*(xy[best + 1] - xy[best]))
    return int(best) + 1 if np.min(apart) < 3 * step + 1e-3 else None


# --- drawing ---------------------------------------------------------------------------------------------------------------

def chart(result, curves, points, parameters, units, scale):
    words = f"{len(curves)} curve{'s' if len(curves) > 1 else ''}"
    threshold = next((p for p in points if p.kind == "threshold"), None)
    study_value = result.group("study").attributes.get(parameters[1], model_parameters(result).get(parameters[1]))
    symbols = [SYMBOLS.get(p, p) for p in parameters]
    views = [outer_limits(curves, points, study_value, scale)]
    if threshold:
        views.append(threshold.place[:, None] + WINDOW * scale[:, None])
        views[0] = np.column_stack([np.minimum(views[0][:, 0], views[1][:, 0] - 0.01 * scale), views[0][:, 1]])
    shown = [p for p in points if inside(p.place, views[0])]
    keys = chart_keys(curves, shown, symbols[1], units[1], study_value)
    page = Page(7.0, 4.6 + (2.9 if threshold else 0), title(curves, symbols), [study_sentence(result, words, parameters)], keys)
    panels = page.subplots(2 if threshold else 1, 1, height_ratios=[1.6, 1.0] if threshold else [1])[:, 0]
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
        frame = views[1] if threshold and k == 0 else None
        write_names(axes, curves, shown, view, threshold_words(threshold, symbols, units), frame)
    return page.figure


def title(curves, symbols):
    nouns = {"WH": "whirling", "BP": "branch", "LP": "fold", "HB": "Hopf", "PD": "period-doubling", "SB": "symmetry-breaking", "TR": "torus",
             "RP": "peak"}
    words = [nouns[k] for k in CURVES if any(c.kind == k for c in curves)]
    joined = " and ".join(filter(None, (", ".join(words[:-1]), words[-1])))
    return f"{joined[0].upper()}{joined[1:]} points in the plane of {symbols[0]} and {symbols[1]}"


def study_sentence(result, words, parameters):
    """What is fixed; both parameters of the plane are left out."""
    fixed = {key: value for key, value in result.group("study").attributes.items() if key not in parameters}
    for key, symbol in (("damping.out_of_plane", r"$\zeta_1$"), ("damping.in_plane", r"$\zeta_2$")):
        words += f", {symbol} = {fixed[key]:g}" if key in fixed else ""
    return study_words(Group(groups={"study": Group("/study", fixed), "model": result.group("model")}), words, damping=False)


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
        for line, first, last in c.pieces():
            axes.plot(*c.xy[first:last + 1].T, color=c.colour, **LINES[line])
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
    for kind, (colour, lines, words) in CURVES.items():
        drawn = {line for c in curves if c.kind == kind for line, _, _ in c.pieces()}
        for line in lines:
            if line in drawn:
                which = {"solid": ", supercritical", "dotted": ", subcritical"}.get(line, "") if len(lines) > 1 else ""
                keys.append(line_key(words + which, color=colour, **LINES[line]))
    for kind, (marker, size, words) in POINTS.items():
        if any(p.kind == kind for p in points):
            words = f"{words} of {symbol} on a curve" if kind in QUIET else words
            style = {k: v for k, v in marker_style(kind).items() if k != "linestyle"}
            keys.append(marker_key(words, marker, markersize=size, **style))
    if study_value is not None:
        keys.append(line_key(f"{quantity(symbol, f'{study_value:g}', unit)} in this study", color=GREY, linewidth=0.8))
    return keys


def quantity(symbol, value, unit):
    return f"{symbol} = {value} {unit}" if unit not in ("", "-") else f"{symbol} = {value}"


def threshold_words(threshold, symbols, units):
    if threshold is None:
        return ""
    return "\n".join(["threshold", *(quantity(symbols[i], number(threshold.place[i], 6), units[i]) for i in (1, 0))])


def write_names(axes, curves, points, view, threshold_text, frame):
    """Names of curves and points in one panel; those inside the frame wait for the panel that enlarges it."""
    tags = []
    for p in points:
        if p.kind in QUIET or not inside(p.place, view):
            continue
        if frame is None or not inside(p.place, frame):
            tags.append(Tag(threshold_text if p.kind == "threshold" else p.name(points), [tuple(p.place)], INK))
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
    picks = np.unique(np.linspace(0.05 * len(good), max(0.95 * len(good) - 1, 0), most).astype(int)) if good else []
    return [tuple(good[i]) for i in picks]
