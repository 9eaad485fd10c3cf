"""Figures of a basin map: the plane of starts coloured and hatched by attractor, the attractors' motions, how long starts take."""
import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.patches import Patch

from figures_common import CYCLE, INK, PALE, VERMILLION, Page, label, letter, marker_key, study_words
from integration_figures import axis_label, coordinate_keys, coordinates, draw_lines, draw_orbit, motion_words, symbol, text_column

FLOOR = 1e-3
HATCHES = ("", "////", "....", "xxxx", "\\\\\\\\", "||||", "oo", "++", "--", "**")  # none for the first: it is often most of the plane
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "h", "<", ">")
OTHER = {0: ("#ffffff", "unsettled"), -1: ("#3a3a3a", "diverging"), -2: (PALE, "not computed")}


def figures(result):
    made = [basins(result), periods(result), motions(result)]
    return [f for f in made if f]


def study(result):
    omega = result.group("basins").attributes.get("omega", float("nan"))
    return rf"$\omega$ = {omega:.6g} rad/s, " + study_words(result, "basins of attraction", varied="omega")


def soft(colour):
    """A lighter shade: points and hatches stay visible on it."""
    rgb = np.array([int(colour[k:k + 2], 16) for k in (1, 3, 5)]) / 255
    return tuple(0.45 + 0.55 * rgb)


def plane(result):
    """(x values, y values, attractor numbers as rows of y)."""
    table = result.group("basins/map")
    nx, ny = (int(n) for n in result.group("basins").attributes["resolution"])
    return table.column("x")[:nx], table.column("y")[::nx], table.column("attractor").reshape(ny, nx).astype(int)


def edges(values):
    if len(values) == 1:
        return np.array([values[0] - 0.5, values[0] + 0.5])
    half = 0.5 * np.diff(values)
    return np.concatenate([[values[0] - half[0]], values[:-1] + half, [values[-1] + half[-1]]])


def axes_of(result):
    return [str(name) for name in result.group("basins").attributes["axes"]]


def state_label(result, which, name):
    return label(symbol(name), result.group("basins/map").units[which])


def label_axes(axes, result):
    x, y = axes_of(result)
    axes.set_xlabel(f"start {state_label(result, 'x', x)}")
    axes.set_ylabel(f"start {state_label(result, 'y', y)}")


# --- basins ----------------------------------------------------------------------------------------------------------------

def basins(result):
    if not result.group("basins/map").rows():
        return None
    x, y, cells = plane(result)
    table = result.group("basins/attractors")
    present = [int(k) for k in np.unique(cells)]
    keys = [Patch(facecolor=soft(CYCLE[(k - 1) % len(CYCLE)]), hatch=HATCHES[(k - 1) % len(HATCHES)], edgecolor=INK, linewidth=0.4,
                  label=attractor_words(table, k)) for k in present if k > 0]
    keys += [Patch(facecolor=OTHER[k][0], edgecolor=INK, linewidth=0.4, label=OTHER[k][1]) for k in present if k <= 0]
    keys += [marker_key(f"stroboscopic points of A{k}", MARKERS[(k - 1) % len(MARKERS)], markersize=6, color=CYCLE[(k - 1) % len(CYCLE)],
                        markeredgecolor=INK) for k in present if k > 0]
    page = Page(6.4, 5.4, "Basins of attraction", [accuracy(result), study(result)], keys)
    axes = page.subplots()[0, 0]
    draw_cells(axes, x, y, cells)
    draw_points(axes, result, present)
    label_axes(axes, result)
    name_regions(axes, x, y, cells)
    return "basins", page.finish()


def attractor_words(table, number):
    row = int(np.flatnonzero(table.column("number") == number)[0])
    return (f"A{number}: {motion_words(text_column(table, 'motion', row), table.column('multiple')[row])}, "
            f"{100 * table.column('share')[row]:.1f} % of the starts")


def accuracy(result):
    group = result.group("basins").columns
    if not {"checked", "disagreed"} <= group.keys() or group["checked"] == 0:
        return ""
    return (f"Of {int(group['checked'])} starts integrated again at the fine tolerance and to the end, {int(group['disagreed'])} went "
            "elsewhere.")


def draw_cells(axes, x, y, cells):
    numbers = np.unique(cells)
    colours = [soft(CYCLE[(k - 1) % len(CYCLE)]) if k > 0 else OTHER[int(k)][0] for k in numbers]
    index = np.searchsorted(numbers, cells)
    axes.pcolormesh(edges(x), edges(y), index, cmap=ListedColormap(colours), vmin=-0.5, vmax=len(numbers) - 0.5, rasterized=True)
    for k in numbers:
        hatch = HATCHES[(k - 1) % len(HATCHES)] if k > 0 else ""
        if hatch and min(cells.shape) > 1:
            axes.contourf(x, y, (cells == k).astype(float), levels=[0.5, 1.5], colors="none", hatches=[hatch])
    axes.set_xlim(edges(x)[[0, -1]])
    axes.set_ylim(edges(y)[[0, -1]])


def draw_points(axes, result, present):
    """Stroboscopic points seen along the other states: they lie in the plane itself only by chance."""
    points, (sx, sy) = result.group("basins/points"), axes_of(result)
    for k in present:
        mine = points.column("attractor") == k if points.rows() and k > 0 else np.array([], dtype=bool)
        few = np.count_nonzero(mine) <= 24
        axes.plot(points.column(sx)[mine] if len(mine) else [], points.column(sy)[mine] if len(mine) else [], linestyle="none",
                  marker=MARKERS[(k - 1) % len(MARKERS)], markersize=6.5 if few else 2, color=CYCLE[(k - 1) % len(CYCLE)],
                  markeredgecolor="white", markeredgewidth=1.2 if few else 0, zorder=5)
        axes.plot(points.column(sx)[mine] if len(mine) else [], points.column(sy)[mine] if len(mine) else [], linestyle="none",
                  marker=MARKERS[(k - 1) % len(MARKERS)], markersize=6.5 if few else 2, markerfacecolor="none", markeredgecolor=INK,
                  markeredgewidth=0.6 if few else 0, zorder=6)


def name_regions(axes, x, y, cells):
    """The number of each attractor in the widest free place of its basin."""
    for k in np.unique(cells):
        if k <= 0:
            continue
        room = depth(cells == k)
        j, i = np.unravel_index(int(np.argmax(room)), room.shape)
        if room[j, i] >= 0.02 * max(cells.shape):
            axes.annotate(f"A{k}", (x[i], y[j]), ha="center", va="center", fontsize=9, fontweight="bold", zorder=7,
                          bbox={"boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": INK, "linewidth": 0.5})


def depth(mask):
    """Steps from each cell of a region to its border, by peeling; the frame is a border."""
    rest, steps = np.pad(mask, 1), np.zeros(mask.shape, dtype=int)
    while rest.any():
        steps += rest[1:-1, 1:-1]
        inner = rest.copy()
        for axis in (0, 1):
            for shift in (1, -1):
                inner &= np.roll(rest, shift, axis)
        rest = inner
    return steps


# --- periods ---------------------------------------------------------------------------------------------------------------

def periods(result):
    """How long a start takes until it is decided: long near the borders."""
    table = result.group("basins/map")
    if not table.rows():
        return None
    x, y, cells = plane(result)
    taken = np.where(cells == -2, np.nan, table.column("periods").reshape(cells.shape).astype(float))
    page = Page(6.4, 5.2, "Excitation periods until a start is decided", [study(result)])
    axes = page.subplots()[0, 0]
    top = float(np.nanpercentile(taken, 99)) if np.isfinite(taken).any() else 1.0
    mesh = axes.pcolormesh(edges(x), edges(y), taken, cmap="cividis", vmin=0, vmax=max(top, 1.0), rasterized=True)
    page.figure.colorbar(mesh, ax=axes, label="excitation periods", extend="max", pad=0.02)
    label_axes(axes, result)
    return "periods", page.finish()


# --- motions ---------------------------------------------------------------------------------------------------------------

def motions(result):
    """Each attractor: orbit with stroboscopic points, spectrum."""
    table = result.group("basins/attractors")
    rows = list(range(min(table.rows(), 6)))
    if not rows:
        return None
    names = coordinates(result.group(f"basins/{text_column(table, 'attractor', 0)}/series"))
    keys = [*coordinate_keys(names), marker_key("stroboscopic points", "o", markersize=5, markerfacecolor="white", markeredgecolor=VERMILLION,
                                                markeredgewidth=1.3)]
    page = Page(7.0, 2.1 * len(rows) + 0.2, "Motions on the attractors", [study(result)], keys)
    panels = page.subplots(len(rows), 2, gridspec_kw={"width_ratios": [1, 1.3]})
    for i, row in enumerate(rows):
        name = text_column(table, "attractor", row)
        series = result.group(f"basins/{name}/series")
        extent = [np.ptp(series.column(q)) for q in names]
        whirls = len(names) > 1 and min(extent[:2]) > 1e-6 * max(extent[:2])
        moving = names[int(np.argmax(extent))]
        states = (names[0], names[1]) if whirls else (moving, f"{moving}'")
        draw_orbit(panels[i, 0], series, Points(result.group("basins/points"), table.column("number")[row]), states)
        panels[i, 0].set_xlabel(axis_label(series, states[0]), labelpad=1)
        panels[i, 0].set_ylabel(axis_label(series, states[1]), labelpad=1)
        panels[i, 0].set_title(f"{letter(i)} {attractor_words(table, int(table.column('number')[row]))}", loc="left", fontsize=9)
        draw_lines(panels[i, 1], result.group(f"basins/{name}/spectrum"), result.group(f"basins/{name}/amplitude_spectrum"), names, FLOOR,
                   series.units[names[0]])
    panels[-1, 1].set_xlabel(r"frequency / $\omega$")
    return "motions", page.finish()


class Points:
    """The rows of one attractor in the table of all points."""

    def __init__(self, table, number):
        self.table, self.mine = table, table.column("attractor") == number

    def column(self, name):
        return self.table.column(name)[self.mine]
