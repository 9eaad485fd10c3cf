"""Figures of a cycles study: equilibria and the extremes of the limit cycles against the parameter, their periods, and orbits at special points."""
import numpy as np

import figures_two_parameter

from figures_branches import bifurcation_panel, drawable, write_tags
from figures_common import (CYCLE, INK, Page, SYMBOLS, draw_branch, knots_of, label, letter, parameter_of, special_keys, special_points,
                            stability_keys, study_words)

ORBITS = 12      # drawn at most
TAGGED = 14      # points named in a panel; more would cover the curves
BESIDE = 0.15    # of the cycles' range: so much is shown on either side of it
PERIOD = "cycle_period"


def figures(result):
    names = drawable(result)
    if not names:
        return []
    return [drawn for drawn in (diagram(result, names), orbits(result)) if drawn] + figures_two_parameter.figures(result)


def is_cycles(branch):
    return np.max(branch.column(PERIOD)) > 0.0


def quantities(branch):
    return [c[:-4] for c in branch.columns if c.endswith("_max") and c[:-4] + "_min" in branch.columns]


def leading(result, names):
    """The quantity that moves most along the cycles, of those the study names first."""
    cycles = [b for b in (result.group("branches").group(n) for n in names) if is_cycles(b)]
    first = result.group("branches").group(names[0])
    if not cycles:
        return quantities(first)[0]
    return max(quantities(first), key=lambda q: max(np.ptp(np.concatenate([b.column(q + "_max"), b.column(q + "_min")])) /
                                                     (1e-300 + np.max(np.abs(b.column(q + "_max")))) for b in cycles))


def diagram(result, names):
    branches = {n: result.group("branches").group(n) for n in names}
    cycles = [n for n in names if is_cycles(branches[n])]
    first = branches[names[0]]
    x, q = parameter_of(result, first), leading(result, names)
    colours, used = {}, 0
    for n in names:
        colours[n] = INK if n not in cycles else CYCLE[used % len(CYCLE)]
        used += n in cycles
    low, high = shown_range([branches[n].column(x) for n in cycles or names])
    table = result.group("special_points")
    points = [p for p in special_points(result, [x, q + "_max", PERIOD]) if low <= table.column(x)[p.row] <= high]
    named = points if len(points) <= TAGGED else []
    panels = [q + "_max"] + ([PERIOD] if cycles else [])
    sentence = study_words(result, f"{len(names) - len(cycles)} branches of equilibria (black), {len(cycles)} of limit cycles: largest and least {q}")
    page = Page(7.0, 3.0 * len(panels) + 0.6, "Limit cycles", [sentence],
                stability_keys(list(branches.values())) + special_keys(points))
    axes = page.subplots(len(panels), 1, sharex=True)[:, 0]
    bifurcation_panel(axes[0], result, names, x, q + "_max", points, colours.get)
    for n in cycles:
        draw_branch(axes[0], knots_of(result, n, [x, q + "_min"]), x, q + "_min", colours[n])
    axes[0].set_ylabel(label(SYMBOLS.get(q, q), first.units[q + "_max"]))
    if cycles:
        on_cycles = [p for p in points if p.branch in cycles]
        bifurcation_panel(axes[1], result, cycles, x, PERIOD, on_cycles, colours.get)
        axes[1].set_ylabel(label("period", first.units[PERIOD]))
    axes[0].set_xlim(low, high)
    frame(axes[0], [branches[n].column(q + side)[(branches[n].column(x) >= low) & (branches[n].column(x) <= high)]
                    for n in names for side in ("_max", "_min")])
    axes[-1].set_xlabel(label(SYMBOLS.get(x, x), first.units[x]))
    page.finish()
    write_tags(axes[0], result, [], x, q + "_max", named, colours.get)
    if cycles:
        write_tags(axes[1], result, cycles, x, PERIOD, [p for p in named if p.branch in cycles], colours.get)
    return ("branches", page.figure)


def shown_range(columns):
    low, high = min(c.min() for c in columns), max(c.max() for c in columns)
    margin = BESIDE * ((high - low) or 1.0)
    return low - margin, high + margin


def frame(axes, columns):
    """The height of what is shown."""
    low, high = min(c.min() for c in columns if c.size), max(c.max() for c in columns if c.size)
    margin = 0.05 * ((high - low) or 1.0)
    axes.set_ylim(low - margin, high + margin)


def orbits(result):
    """Cycles at special points in the plane of the two variables that move most."""
    groups = result.group("orbits").groups if result.group("orbits") else {}
    if not groups:
        return None
    chosen = list(groups)[:ORBITS]
    variables = [c for c in groups[chosen[0]].columns if c != "t" and groups[chosen[0]].descriptions.get(c, "variable") != ""]
    size = {v: max(np.ptp(groups[n].column(v)) for n in chosen) for v in variables}
    plain = [v for v in variables if "root of the sum" not in groups[chosen[0]].descriptions.get(v, "")] or variables
    a, b = sorted(sorted(plain, key=lambda v: -size[v])[:2], key=plain.index) if len(plain) > 1 else (plain[0], plain[0])
    columns = min(4, len(chosen))
    rows = -(-len(chosen) // columns)
    left = len(groups) - len(chosen)
    page = Page(7.0, 1.9 * rows + 0.3, "Orbits at special points",
                [study_words(result, f"{b} over {a}" + (f"; {left} more in the file" if left else ""))])
    axes = page.subplots(rows, columns, sharex=True, sharey=True)
    x, special = parameter_of(result, result.group("branches").group(drawable(result)[0])), result.group("special_points")
    places = {f"{br}_{lb}": value for br, lb, value in zip(special.column("branch"), special.column("label"), special.column(x))}
    for k, panel in enumerate(axes.flat):
        if k >= len(chosen):
            panel.set_visible(False)
            continue
        orbit = groups[chosen[k]]
        panel.plot(orbit.column(a), orbit.column(b), color=CYCLE[0], linewidth=1.2)
        panel.set_title(f"{letter(k)} {chosen[k].replace('_', ' ')}\n{x} = {places.get(chosen[k], float('nan')):.6g}", fontsize=8, loc="left")
        panel.grid(True, color="#ececec", linewidth=0.6)
        panel.tick_params(labelsize=7.5)
    for panel in axes[-1, :]:
        panel.set_xlabel(label(a, orbit.units[a]))
    for panel in axes[:, 0]:
        panel.set_ylabel(label(b, orbit.units[b]))
    page.finish()
    return ("orbits", page.figure)
