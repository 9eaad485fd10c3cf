"""Figures of a compare study: branches of every level with the integrated sweeps, special points level by level, map of the averaged error."""
import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap

from figures_branches import drawable
from figures_common import (BLUE, DASHES, GREEN, GREY, INK, PURPLE, SYMBOLS, VERMILLION, Page, label, line_key, marker_key, study_words)

# Colour, width and words of each level.
LEVELS = {"exact": (INK, 2.2, "exact periodic motion"), "frozen": (BLUE, 1.4, "averaged, linear response frozen"),
          "complete": (VERMILLION, 1.2, "averaged, complete ansatz")}
SWEEPS = {"up": ("^", GREEN, "integrated, frequency rising"), "down": ("v", PURPLE, "integrated, frequency falling")}
WORDS = {"q1": "out of plane", "q2": "in plane"}
COORDINATES = 3
BANDS = [0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0]


def figures(result):
    return [d for d in (figure(result) for figure in (response, points, error_map)) if d]


def sentence(result):
    return study_words(result, "Comparison of levels")


def level_of(branch):
    return str(branch.attributes.get("level", "exact"))


def amplitude_columns(branches):
    """Amplitudes at n omega of the coordinates (q1, y1, z1, ...) that move most on any branch, in the order of the file."""
    every = [c for c in branches[0].columns if c[0] in "qyz" and "_h" in c and not c.endswith("_phase")]
    foremost = sorted(every, key=lambda c: max(np.nanmax(b.column(c), initial=0.0) for b in branches), reverse=True)[:COORDINATES]
    return [c for c in every if c in foremost]


# --- response --------------------------------------------------------------------------------------------------------------

def response(result):
    names = drawable(result)
    if not names:
        return None
    branches = [result.group("branches").group(n) for n in names]
    columns = amplitude_columns(branches)
    order = columns[0].split("_h")[1]
    levels = [k for k in LEVELS if any(level_of(b) == k for b in branches)]
    keys = [line_key(LEVELS[k][2], color=LEVELS[k][0], linewidth=LEVELS[k][1]) for k in levels]
    keys += [line_key("stable", color=GREY, linewidth=1.6), line_key("unstable", color=GREY, linewidth=1.2, linestyle=DASHES)]
    sweeps = [w for w in SWEEPS if result.group(f"sweep/{w}")]
    keys += [marker_key(SWEEPS[w][2], SWEEPS[w][0], color=SWEEPS[w][1], markersize=4) for w in sweeps]
    page = Page(7.2, 3.1 * len(columns), f"Amplitude at {order}ω: averaged, exact and integrated", [sentence(result)], keys)
    panels = page.subplots(len(columns), 1, sharex=True)[:, 0]
    for axes, column in zip(panels, columns):
        for b in branches:
            colour, width, _ = LEVELS[level_of(b)]
            draw(axes, b, column, colour, width)
        for way in sweeps:
            table = result.group(f"sweep/{way}")
            axes.plot(table.column("omega"), table.column(column), linestyle="none", marker=SWEEPS[way][0], color=SWEEPS[way][1], markersize=3.6,
                      markerfacecolor="none", markeredgewidth=0.9, zorder=5)
        q = column.split("_")[0]
        words = f", {WORDS[q]}" if q in WORDS and result.group("cable") else ""
        axes.set_ylabel(label(rf"$|{q[0]}_{{{q[1:]}}}|$ at {order}$\omega$", branches[0].units[column]) + words)
        axes.grid(True, color="#ececec", linewidth=0.6)
        axes.set_axisbelow(True)
    panels[-1].set_xlabel(label(SYMBOLS["omega"], "rad/s"))
    page.finish()
    return "response", page.figure


def draw(axes, branch, column, colour, width):
    """Stable solid, unstable dashed; a stretch takes the stability of its ends."""
    x, y, unstable = branch.column("omega"), branch.column(column), branch.column("n_unstable") > 0
    calm = ~(unstable[:-1] | unstable[1:])
    first = 0
    for i in range(1, len(calm) + 1):
        if i == len(calm) or calm[i] != calm[first]:
            axes.plot(x[first:i + 1], y[first:i + 1], color=colour, linewidth=width if calm[first] else 0.75 * width,
                      linestyle="-" if calm[first] else DASHES, zorder=3 if calm[first] else 2.5)
            first = i


# --- special points --------------------------------------------------------------------------------------------------------

def points(result):
    table = result.group("compare/points")
    if not table or table.rows() == 0:
        return None
    rows = sorted(range(table.rows()), key=lambda i: np.nanmin([table.column(f"omega_{k}")[i] for k in LEVELS]))
    keys = [marker_key(LEVELS[k][2], "o", color=LEVELS[k][0], markersize=6) for k in LEVELS]
    keys.append(marker_key("integrated transition", "|", color=GREEN, markersize=11, markeredgewidth=1.8))
    page = Page(7.2, 0.36 * len(rows) + 0.9, "Special points, level by level", [sentence(result)], keys)
    axes = page.subplots()[0, 0]
    names = []
    for y, i in enumerate(rows):
        at = {k: table.column(f"omega_{k}")[i] for k in LEVELS}
        known = [v for v in at.values() if np.isfinite(v)]
        axes.plot([min(known), max(known)], [y, y], color=GREY, linewidth=0.9, zorder=1)
        for k, size in (("exact", 8.5), ("complete", 5.5), ("frozen", 5.5)):
            axes.plot(at[k], y, marker="o", color=LEVELS[k][0], markersize=size, zorder=3 if k == "exact" else 4)
        axes.plot(table.column("omega_integrated")[i], y, marker="|", color=GREEN, markersize=13, markeredgewidth=1.8, zorder=5)
        found = str(table.column("found")[i])
        names.append(f"{table.column('kind')[i]} {table.column('branch')[i]}" + ("" if found == "all" else f" ({found})"))
    axes.set_yticks(range(len(rows)), names)
    axes.invert_yaxis()
    axes.set_xlabel(label(SYMBOLS["omega"], "rad/s"))
    axes.grid(True, axis="x", color="#ececec", linewidth=0.6)
    axes.set_axisbelow(True)
    page.finish()
    return "points", page.figure


# --- map -------------------------------------------------------------------------------------------------------------------

def error_map(result):
    table = result.group("compare/map")
    if not table or table.rows() < 4:
        return None
    name = next(c for c in table.columns if c not in ("omega", "error", "amplitude", "same_kinds"))
    x, y = np.unique(table.column("omega")), np.unique(table.column(name))
    grid = {c: np.full((len(y), len(x)), np.nan) for c in ("error", "same_kinds")}
    i, j = np.searchsorted(y, table.column(name)), np.searchsorted(x, table.column("omega"))
    for c in grid:
        grid[c][i, j] = table.column(c)
    tolerance = float(result.group("study").attributes.get("compare.tolerance", 0.1))
    words = str(result.group("compare").attributes.get("sentence", ""))
    keys = [marker_key("stable motions differ in number or kind", "x", color=INK, markersize=4),
            line_key(f"trusted up to here ({100 * tolerance:g} %)", color=INK, linewidth=1.4, linestyle=DASHES)]
    page = Page(7.2, 3.9, "Relative error of the averaged amplitude", [sentence(result), words[:1].upper() + words[1:] + "."], keys)
    axes = page.subplots()[0, 0]
    colours = ListedColormap(["#f7fbff", "#deebf7", "#c6dbef", "#9ecae1", "#fdd0a2", "#fd8d3c", "#d94801"])
    mesh = axes.pcolormesh(edges(x), edges(y), np.clip(grid["error"], 0, 0.999), cmap=colours, norm=BoundaryNorm(BANDS, colours.N))
    differ = np.argwhere(grid["same_kinds"] == 0)
    axes.plot(x[differ[:, 1]], y[differ[:, 0]], linestyle="none", marker="x", color=INK, markersize=3.2, markeredgewidth=0.8)
    limit = float(result.group("compare").attributes.get("trusted_up_to", np.nan))
    if np.isfinite(limit):
        axes.axhline(limit, color=INK, linewidth=1.4, linestyle=DASHES)
    bar = page.figure.colorbar(mesh, ax=axes, ticks=BANDS, fraction=0.045, pad=0.02)
    bar.ax.set_yticklabels([f"{100 * b:g} %" for b in BANDS[:-1]] + ["100 %\nor more"])
    axes.set_xlabel(label(SYMBOLS["omega"], "rad/s"))
    axes.set_ylabel(label(SYMBOLS.get(name, name), table.units[name]))
    page.finish()
    return "map", page.figure


def edges(centres):
    middle = 0.5 * (centres[1:] + centres[:-1])
    return np.concatenate([[2 * centres[0] - middle[0]], middle, [2 * centres[-1] - middle[-1]]])
