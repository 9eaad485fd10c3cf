"""Figures of a periodic study: peaks and harmonics of the exact motions, Floquet multipliers, orbits, chart of special points."""
import numpy as np

import figures_two_parameter
from figures_branches import bifurcation_panel, drawable, write_tags
from figures_common import (CYCLE, DASHES, GREY, INK, SYMBOLS, Page, draw_branch, knots_of, label, letter, line_key, number, parameter_of,
                            special_keys, special_points, stability_keys, study_words)

COORDINATES = 3     # panels of coordinates at the most
HARMONICS = 4       # rows of harmonics at the most
WORDS = {"q1": "out of plane", "q2": "in plane"}


def figures(result):
    drawn = [figure(result) for figure in (response, harmonics, multipliers, orbits)]
    return [d for d in drawn if d] + figures_two_parameter.figures(result)


# --- reading ---------------------------------------------------------------------------------------------------------------

def coordinates(branch):
    return [c[:-4] for c in branch.columns if c.endswith("_max") and c != "tension_max"]


def leading(result, names, most):
    """The coordinates that move most on any branch, in the order of the file."""
    every = coordinates(result.group("branches").group(names[0]))
    foremost = sorted(every, key=lambda q: largest(result, names, f"{q}_max"), reverse=True)[:most]
    return [q for q in every if q in foremost]


def harmonics_of(branch, coordinate):
    """Multiples of omega of which the file has amplitudes."""
    names = [c[len(coordinate) + 2:] for c in branch.columns if c.startswith(coordinate + "_h") and not c.endswith("_phase")]
    return sorted((float(k) for k in names))


def column(coordinate, k):
    return f"{coordinate}_h{k:g}"


def is_cable(result):
    return "omega1" in result.group("cable").columns


def axis_label(result, branch, coordinate, symbol):
    words = f", {WORDS[coordinate]}" if is_cable(result) and coordinate in WORDS else ""
    return label(symbol, branch.units[f"{coordinate}_max"]) + words


def tex(coordinate):
    return rf"{coordinate[0]}_{{{coordinate[1:]}}}"


def period_words(branch):
    period = int(branch.attributes.get("period", 1))
    return "" if period == 1 else f" (period {period})"


def page_keys(result, names, points):
    colours = {n: CYCLE[i % len(CYCLE)] for i, n in enumerate(names)}
    branches = [result.group("branches").group(n) for n in names]
    keys = [line_key(n + period_words(b), color=colours[n], linewidth=1.6) for n, b in zip(names, branches)]
    return colours, keys + stability_keys(branches) + special_keys(points)


def first_branch(result):
    names = drawable(result)
    return names, result.group("branches").group(names[0]) if names else None


def sentence(result):
    return study_words(result, "Periodic study")


# --- response --------------------------------------------------------------------------------------------------------------

def response(result):
    names, first = first_branch(result)
    if not names:
        return None
    shown = leading(result, names, COORDINATES)
    x, columns = parameter_of(result, first), [f"{q}_max" for q in shown]
    points = special_points(result, [x, *columns])
    colours, keys = page_keys(result, names, points)
    page = Page(7.0, 3.3 * len(shown) + 0.4, "Exact periodic motions: largest displacement over the period", [sentence(result)], keys)
    panels = page.subplots(len(shown), 1, sharex=True)[:, 0]
    for axes, q, y in zip(panels, shown, columns):
        bifurcation_panel(axes, result, names, x, y, points, colours.get)
        axes.set_ylabel(axis_label(result, first, q, rf"$\max|{tex(q)}|$"))
    panels[-1].set_xlabel(label(SYMBOLS.get(x, x), first.units[x]))
    page.finish()
    for axes, y in zip(panels, columns):
        write_tags(axes, result, names, x, y, points, colours.get)
    return "response", page.figure


def harmonics(result):
    names, first = first_branch(result)
    if not names:
        return None
    shown = leading(result, names, COORDINATES)
    x = parameter_of(result, first)
    size = {k: max(largest(result, names, column(q, k)) for q in shown) for k in harmonics_of(first, shown[0])}
    chosen = sorted(sorted(size, key=size.get, reverse=True)[:HARMONICS])
    colours, keys = page_keys(result, names, [])
    page = Page(7.4, 1.75 * len(chosen) + 0.3, "Amplitudes of the harmonics of the exact motions", [sentence(result)], keys)
    panels = page.subplots(len(chosen), len(shown), sharex=True)
    for row, k in zip(panels, chosen):
        for axes, q in zip(row, shown):
            for name in names:
                draw_branch(axes, knots_of(result, name, [x, column(q, k)]), x, column(q, k), colours[name], 1.3)
            axes.set_ylabel(label("mean" if k == 0 else rf"at {'' if k == 1 else f'{k:g}'}$\omega$", first.units[column(q, k)]))
            axes.grid(True, color="#ececec", linewidth=0.6)
            axes.set_axisbelow(True)
    for axes, q in zip(panels[0], shown):
        axes.set_title(rf"${tex(q)}$" + (f", {WORDS[q]}" if is_cable(result) and q in WORDS else ""), loc="left")
    for axes in panels[-1]:
        axes.set_xlabel(label(SYMBOLS.get(x, x), first.units[x]))
    page.finish()
    return "harmonics", page.figure


def largest(result, names, name):
    return max(np.max(np.abs(result.group("branches").group(n).column(name))) for n in names)


# --- multipliers -----------------------------------------------------------------------------------------------------------

def spectrum_of(branch):
    """Floquet multipliers, a row a point."""
    count = sum(c.startswith("mu") and c.endswith("_re") for c in branch.columns)
    return np.column_stack([branch.column(f"mu{k + 1}_re") + 1j * branch.column(f"mu{k + 1}_im") for k in range(count)])


def multipliers(result):
    names, first = first_branch(result)
    if not names or "mu1_re" not in first.columns:
        return None
    x = parameter_of(result, first)
    colours = {n: CYCLE[i % len(CYCLE)] for i, n in enumerate(names)}
    keys = [line_key(n + period_words(result.group("branches").group(n)), color=colours[n], linewidth=1.6) for n in names]
    page = Page(7.4, 3.7, "Floquet multipliers over the period of each motion", [sentence(result)], keys)
    plane, size = page.subplots(1, 2)[0]
    turn = np.linspace(0, 2 * np.pi, 400)
    plane.plot(np.cos(turn), np.sin(turn), color=INK, linewidth=1.0, zorder=2)
    reach = 1.0
    for name in names:
        branch = result.group("branches").group(name)
        mu = spectrum_of(branch)
        plane.plot(mu.real.ravel(), mu.imag.ravel(), linestyle="none", marker=".", markersize=2.6, color=colours[name], zorder=3)
        reach = max(reach, float(np.quantile(np.abs(mu), 0.97)))
        size.plot(branch.column(x), np.max(np.abs(mu), axis=1), color=colours[name], linewidth=1.3)
    reach = 1.08 * min(reach, 2.5)
    plane.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal", xlabel=r"Re $\mu$", ylabel=r"Im $\mu$")
    plane.set_title("(a) all multipliers and the unit circle", loc="left")
    size.axhline(1.0, color=INK, linewidth=1.0)
    size.set_ylim(0, min(1.05 * max(np.max(np.abs(spectrum_of(result.group("branches").group(n)))) for n in names), 5.0))
    size.set_xlabel(label(SYMBOLS.get(x, x), first.units[x]))
    size.set_ylabel(r"largest $|\mu|$")
    size.set_title("(b) unstable above 1", loc="left")
    size.grid(True, color="#ececec", linewidth=0.6)
    page.finish()
    return "multipliers", page.figure


# --- orbits ----------------------------------------------------------------------------------------------------------------

def orbits(result):
    motions = list(result.group("verification/motions").groups.values())
    names, first = first_branch(result)
    if not motions or not names or len(coordinates(first)) < 2:
        return None
    a, b = leading(result, names, 2)
    values = sorted({float(m.attributes["omega"]) for m in motions})
    columns = min(len(values), 3)
    rows = -(-len(values) // columns)
    drawn = [n for n in names if any(m.attributes["branch"] == n for m in motions)]
    colours = {n: CYCLE[i % len(CYCLE)] for i, n in enumerate(names)}
    keys = [line_key(n + period_words(result.group("branches").group(n)), color=colours[n], linewidth=1.6) for n in drawn]
    keys += [line_key("stable", color=INK, linewidth=1.6), line_key("unstable", color=INK, linewidth=1.1, linestyle=DASHES)]
    page = Page(7.4, 2.9 * rows + 0.2, rf"Orbits $({tex(a)}, {tex(b)})$ of the exact motions, one excitation frequency a panel", [sentence(result)], keys)
    panels = page.subplots(rows, columns).ravel()
    for k, (axes, value) in enumerate(zip(panels, values)):
        for m in (m for m in motions if float(m.attributes["omega"]) == value):
            stable = m.attributes["stable"] > 0
            axes.plot(m.column(a), m.column(b), color=colours[m.attributes["branch"]], linewidth=1.6 if stable else 1.1,
                      linestyle="-" if stable else DASHES, zorder=3 if stable else 2.5)
        axes.set_title(rf"{letter(k)} $\omega$ = {number(value, 5)} rad/s", loc="left")
        axes.set_xlabel(label(f"${tex(a)}$", first.units[f"{a}_max"]))
        axes.set_ylabel(label(f"${tex(b)}$", first.units[f"{b}_max"]))
        axes.axhline(0, color=GREY, linewidth=0.4, zorder=1)
        axes.axvline(0, color=GREY, linewidth=0.4, zorder=1)
    for axes in panels[len(values):]:
        axes.set_axis_off()
    page.finish()
    return "orbits", page.figure
