"""Bifurcation diagram of any result with branches: the first amplitudes against the parameter. It draws the kinds that have no
figures of their own; the others build on its panel."""
import numpy as np

from figures_common import (CYCLE, GREY, Page, SYMBOLS, Tag, branch_tag, draw_branch, draw_special, knots_of, label, parameter_of,
                            place_tags, special_keys, special_points, stability_keys, study_words)

PANELS = 3


def figures(result):
    names = drawable(result)
    if not names:
        return []
    kind = str(result.group("study").attributes.get("kind", "branches"))
    first = result.group("branches").group(names[0])
    columns = amplitude_columns(first)
    if not columns:
        return []
    x = parameter_of(result, first)
    colours = {name: CYCLE[i % len(CYCLE)] for i, name in enumerate(names)}
    points = special_points(result, [x, *columns])
    keys = stability_keys([result.group("branches").group(n) for n in names]) + special_keys(points)
    sentence = study_words(result, f"{len(names)} branch{'es' if len(names) > 1 else ''}")
    page = Page(7.0, 2.5 * len(columns) + 0.5, f"Bifurcation diagram, {kind} study", [sentence], keys)
    panels = page.subplots(len(columns), 1, sharex=True)[:, 0]
    for axes, column in zip(panels, columns):
        bifurcation_panel(axes, result, names, x, column, points, colours.get)
        axes.set_ylabel(label(column, first.units[column]))
    panels[-1].set_xlabel(label(SYMBOLS.get(x, x), first.units[x]))
    page.finish()
    for axes, column in zip(panels, columns):
        write_tags(axes, result, names, x, column, points, colours.get)
    return [("branches", page.figure)]


def drawable(result):
    return [name for name, branch in result.group("branches").groups.items() if branch.rows() >= 2]


def amplitude_columns(branch):
    """Harmonic amplitudes of the coordinates; failing these, the first columns that are not bookkeeping."""
    amplitudes = [c for c in branch.columns if c.startswith("q") and "_h" in c and not c.endswith("_phase")]
    bookkeeping = {"n_unstable", "arclength", "residual", "step", "newton_iterations", "omega", "omega_ratio", "frequency"}
    others = [c for i, c in enumerate(branch.columns) if i > 0 and c not in bookkeeping and not c.startswith("eig")]
    return (amplitudes or others)[:PANELS]


def bifurcation_panel(axes, result, names, x, y, points, colour_of):
    """Branches and special points; their texts follow after the layout."""
    for name in names:
        draw_branch(axes, knots_of(result, name, [x, y]), x, y, colour_of(name))
    draw_special(axes, result.group("special_points"), points, x, y, colour_of)
    spans = [(c.min(), c.max()) for c in (result.group("branches").group(n).column(x) for n in names)]
    low, high = min(s[0] for s in spans), max(s[1] for s in spans)
    axes.set_xlim(low - 0.01 * (high - low), high + 0.01 * (high - low))
    axes.grid(True, color="#ececec", linewidth=0.6)
    axes.set_axisbelow(True)


def write_tags(axes, result, names, x, y, points, colour_of):
    """Names of special points and of branches, clear of the curves."""
    table = result.group("special_points")
    tags = [Tag(p.name, [(table.column(x)[p.row], table.column(y)[p.row])], colour_of(p.branch)) for p in points]
    tags += [branch_tag(knots_of(result, n, [x, y]), x, y, n, colour_of(n), axes) for n in names if not flat_zero(result, n, y)]
    place_tags(axes, tags)


def flat_zero(result, name, y):
    """A branch that lies on the axis is named in the other panel."""
    return np.max(np.abs(result.group("branches").group(name).column(y))) < 1e-9


def note(axes, text, place=(0.98, 0.94)):
    axes.text(*place, text, transform=axes.transAxes, ha="right", va="top", fontsize=8.5, color=GREY)
