"""Figures of a slow-flow study: amplitudes of every harmonic, orbits, one period in time, starts from rest with spectra."""
import re
from dataclasses import dataclass

import numpy as np

from figures_branches import bifurcation_panel, drawable, write_tags
from figures_common import (BLUE, GREEN, GREY, INK, ORANGE, PURPLE, SYMBOLS, VERMILLION, Page, label, letter, line_key, marker_key,
                            parameter_of, special_keys, special_points, stability_keys, study_words)
from figures_modulation import modulation
from figures_superharmonic import draw_orbits, finish_sheet, grid, orbit_keys, orbit_reach, ordered, smooth

PANELS = 6       # amplitudes drawn: the largest
SAME = 1e-3      # settled motions are one when their harmonics agree to this share of the largest
MOVES = 1e-3     # a coordinate is at rest below this share of the largest displacement
DECADES = 4      # of spectra
COLOURS = {"IP": BLUE, "IPD": GREEN, "W": VERMILLION, "WD": VERMILLION, "P": BLUE, "D": VERMILLION}
WORDS = {"IP": "in plane", "IPD": "in plane, subharmonic", "W": "coupled", "WD": "coupled, subharmonic", "P": "period T",
         "D": "subharmonic"}


def figures(result):
    return [drawn for drawn in (figure(result) for figure in (response, orbits, time, starts, modulation)) if drawn]


def study(result, **which):
    a = result.group("study").attributes
    kind = str(a.get("ansatz.kind", "list"))
    words = {"complete": f"complete ansatz, {a.get('ansatz.harmonics', 0):g} harmonics of ω/{a.get('ansatz.nu', 1):g}",
             "list": "harmonics listed", "frozen": f"{a.get('ansatz.order', 2):g}ω, linear response frozen",
             "combinatorial-32": "combinatorial (3,2), all terms", "combinatorial-32-printed": "combinatorial (3,2), printed terms"}
    motion = f", {a['ansatz.motion']} ansatz" if kind.startswith("combinatorial") and "ansatz.motion" in a else ""
    return study_words(result, f"Slow flow: {words.get(kind, kind)}{motion}", **which)


def nu_of(result):
    return int(result.group("study").attributes.get("nu", 1))


# --- settled motions -------------------------------------------------------------------------------------------------------

@dataclass
class Motion:
    """A settled motion; runs that end on it, or on its mirror image, count once."""
    run: int
    omega: float
    kind: str
    multiple: int
    branch: str       # of the nearest stable averaged motion of this kind, or ""
    amplitudes: dict
    series: object
    mirrored: list    # coordinates whose change of sign maps motions to motions: out of plane

    def words(self):
        out, rest = (max((peak(self.series, q) for q in qs), default=0.0) for qs in planes(self))
        shape = "" if not self.mirrored else "coupled, " if out > MOVES * rest else "in plane, "
        return shape + ((f"{self.multiple}T" if self.multiple > 1 else "T") if self.kind == "periodic" else self.kind)

    def title(self, i):
        return rf"{letter(i)} $\omega$ = {self.omega:g} rad/s: {self.words()}"


def coordinates(series):
    return [q for q in series.columns if q != "t"]


def mirrored_in(result):
    """Coordinates out of plane; q1 in a file that does not tell."""
    names = str(result.group("study").attributes.get("mirrored", "q1"))
    return [q for q in names.split(", ") if q]


def planes(motion):
    """Coordinates out of plane, and the others."""
    return motion.mirrored, [q for q in coordinates(motion.series) if q not in motion.mirrored]


def peak(series, q):
    return np.max(np.abs(series.column(q)))


def leading(tables):
    """The two coordinates that move most in any of the tables, in the file's order; both of two."""
    names = coordinates(tables[0])
    most = sorted(names, key=lambda q: -max(peak(t, q) for t in tables))[:2]
    return [q for q in names if q in most]


def symbol(q):
    return re.sub(r"^([a-z]+)(\d+)$", r"$\1_{\2}$", q)


def harmonics(columns):
    return [c for c in columns if re.fullmatch(r"[a-z]+\d+_h[0-9.]+", c)]


def motions(result):
    table, mirrored, found = result.group("verification/runs"), mirrored_in(result), []
    for row in range(table.rows()):
        series = result.group(f"verification/series/run{row + 1}")
        if not series or table.column("motion")[row] == "failed":
            continue
        spectrum = result.group(f"verification/spectra/run{row + 1}")
        whole = np.array([np.linalg.norm(spectrum.column(q)) for q in coordinates(series)])
        amplitudes = {c: table.column(c)[row] for c in harmonics(table.columns)}
        m = Motion(row + 1, float(table.column("omega")[row]), str(table.column("motion")[row]), int(table.column("multiple")[row]),
                   str(table.column("branch")[row]), amplitudes, series, mirrored)
        numbers = np.append(whole, list(amplitudes.values()))
        if not any(m.omega == o.omega and np.max(np.abs(numbers - known)) < SAME * np.max(known) for o, known in found):
            found.append((m, numbers))
    return [m for m, _ in found]


def averaged(result, omega):
    groups = result.group("verification/averaged").groups
    return [groups[k] for k in groups if np.isclose(groups[k].attributes["omega"], omega, rtol=1e-9)]


# --- response --------------------------------------------------------------------------------------------------------------

def prefix(name):
    return re.sub(r"\d+$", "", name)


def colour_of(name):
    return COLOURS.get(prefix(name), PURPLE)


def response(result):
    names = drawable(result)
    if not names:
        return None
    branches = result.group("branches")
    first = branches.group(names[0])
    x = parameter_of(result, first)
    columns = largest(result, names, harmonics(first.columns))
    points = special_points(result, [x, *columns])
    doubted = any(np.any(contradicted(branches.group(n))) for n in names)
    integrated = motions(result) if x == "omega" else []
    legend = []
    for kind in dict.fromkeys(prefix(n) for n in names):
        legend += stability_keys([branches.group(n) for n in names if prefix(n) == kind], COLOURS.get(kind, PURPLE),
                                 f"{WORDS.get(kind, kind)}, ")
    legend += special_keys(points)
    if doubted:
        legend.append(line_key("Floquet multipliers contradict", color=ORANGE, linewidth=6, alpha=0.35))
    if integrated:
        legend += [marker_key("integrated", "+", color=INK, markersize=8, markeredgewidth=1.4)]
        if any(not m.branch for m in integrated):
            legend += [marker_key("integrated, no stable averaged partner", "x", color=GREY, markersize=5, markeredgewidth=1.2)]
    wide = 2 if len(columns) > 2 else 1
    rows = -(-len(columns) // wide)
    title = "Amplitudes of the averaged motion" + (" and time integration" if integrated else "")
    page = Page(7.6, 2.35 * rows + 0.4, title, [study(result)], legend)
    panels = page.subplots(rows, wide, sharex=True)
    for axes, column in zip(panels.ravel(), columns):
        for n in names:
            underlay(axes, branches.group(n), x, column)
        bifurcation_panel(axes, result, names, x, column, points, colour_of)
        for m in integrated:
            mean = column.endswith("_h0")
            value = np.sign(np.sum(first.column(column)) or 1) * m.amplitudes[column] if mean else m.amplitudes[column]
            look = {"marker": "+", "markersize": 8, "markeredgewidth": 1.4, "color": INK} if m.branch else {
                "marker": "x", "markersize": 5, "markeredgewidth": 1.2, "color": GREY}
            axes.plot([m.omega], [value], linestyle="none", zorder=7, **look)
        axes.set_ylabel(label(amplitude_symbol(column), first.units[column]))
    finish_sheet(panels, len(columns), label(SYMBOLS.get(x, x), first.units[x]), "")
    for axes, column in zip(panels.ravel(), columns):
        axes.set_ylabel(label(amplitude_symbol(column), first.units[column]))
        axes.tick_params(labelbottom=True)
    page.finish()
    for axes, column in zip(panels.ravel()[:1], columns[:1]):
        write_tags(axes, result, names, x, column, points, colour_of)
    return "response", page.figure


def amplitude_symbol(column):
    q, h = column.split("_h")
    return f"{symbol(q)}: mean" if float(h) == 0 else f"{symbol(q)} at {fraction(float(h))}"


def fraction(h):
    for d in (1, 2, 3, 4, 5, 6, 8):
        if abs(h * d - round(h * d)) < 1e-6:
            n = round(h * d)
            return (r"$\omega$" if n == 1 else rf"{n}$\omega$") if d == 1 else rf"{n}$\omega$/{d}" if n != 1 else rf"$\omega$/{d}"
    return rf"{h:g}$\omega$"


def largest(result, names, columns):
    """The amplitudes that matter, in the file's order."""
    size = {c: max(np.max(np.abs(result.group("branches").group(n).column(c))) for n in names) for c in columns}
    chosen = sorted((c for c in columns if size[c] > 1e-9), key=size.get, reverse=True)[:PANELS]
    return [c for c in columns if c in chosen] or columns[:1]


def contradicted(branch):
    """Points whose averaged stability the Floquet multipliers of the same motion deny; nothing is said of those within 1e-6 of 1."""
    if "floquet_modulus" not in branch.columns:
        return np.zeros(branch.rows(), dtype=bool)
    modulus = branch.column("floquet_modulus")
    clear = np.abs(modulus - 1) > 1e-6
    return clear & ((modulus > 1) != (branch.column("n_unstable") > 0))


def underlay(axes, branch, x, y):
    doubt = contradicted(branch)
    values = np.where(doubt, branch.column(y), np.nan)
    if np.any(doubt):
        axes.plot(branch.column(x), values, color=ORANGE, linewidth=6, alpha=0.35, zorder=1, gid="background", solid_capstyle="round")


# --- orbits ----------------------------------------------------------------------------------------------------------------

def orbits(result):
    """Every settled coupled motion on the averaged coupled motions of its frequency, stable and unstable, in the plane of the coordinates that
    move most out of plane and in it."""
    coupled = [m for m in motions(result) if m.words().startswith("coupled")]
    if not coupled:
        return None
    plane = x, y = [max(qs, key=lambda q: max(peak(m.series, q) for m in coupled)) for qs in planes(coupled[0])]
    cells = []
    for m in coupled:
        partners = [o for o in averaged(result, m.omega) if peak(o, x) > MOVES * peak(o, y)]
        if partners:
            cells.append((m.title(len(cells)), partners, m.series))
    if not cells:
        return None
    columns = min(len(cells), 2)
    rows = -(-len(cells) // columns)
    left, right, low, high = orbit_reach(cells, plane)
    panel = (7.6 - 0.7) / columns
    height = min(panel * (high - low) / (right - left), 4.5)
    page = Page(7.6, rows * (height + 0.62) + 0.2, "Coupled orbits: averaged against integrated",
                [study(result)], orbit_keys(cells))
    panels = page.subplots(rows, columns)
    for axes, (words, partners, series) in zip(panels.ravel(), cells):
        draw_orbits(axes, partners, series, plane)
        axes.set_title(words, loc="left")
        axes.axis((left, right, low, high))
        axes.set_aspect("equal")
    sides = (", out of plane", ", in plane") if "support_motion.amplitude" in result.group("study").attributes else ("", "")
    finish_sheet(panels, len(cells), *(label(symbol(q), coupled[0].series.units[q]) + side for q, side in zip(plane, sides)))
    return "orbits", page.finish()


# --- time ------------------------------------------------------------------------------------------------------------------

def aligned(result, m):
    """The averaged motions of the run's branch, shifted by whole excitation periods and mirrored so that they lie nearest; the nearest one."""
    period, nu = 2 * np.pi / m.omega, nu_of(result)
    t = np.linspace(0, nu * period, 200 * nu + 1)
    integrated = periodic(m, t)
    best = None
    for orbit in averaged(result, m.omega):
        if orbit.attributes["branch"] != m.branch or not orbit.attributes["stable"]:
            continue
        for shift in range(nu):
            values = {q: np.interp(np.mod(t + shift * period, nu * period), orbit.column("t"), orbit.column(q)) for q in integrated}
            for sign in (1, -1):
                flipped = {q: sign * v if q in m.mirrored else v for q, v in values.items()}
                distance = sum(np.sum((flipped[q] - integrated[q]) ** 2) for q in integrated)
                if best is None or distance < best[0]:
                    best = (distance, flipped)
    return t, integrated, best[1] if best else None


def periodic(m, t):
    """The record at any time; a periodic one repeats."""
    out = {}
    for q in coordinates(m.series):
        time_, values = smooth(m.series, q)
        span = m.multiple * 2 * np.pi / m.omega
        out[q] = np.interp(np.mod(t, span) if m.kind == "periodic" else t, time_, values)
    return out


def time(result):
    chosen = [m for m in motions(result) if m.branch and m.kind == "periodic"]
    if not chosen:
        return None
    rows, columns = grid(len(chosen))
    names = leading([m.series for m in chosen])
    keys = [line_key(f"{symbol(q)} integrated", color=colour, linewidth=1.3) for q, colour in zip(names, (VERMILLION, BLUE))] + [
            line_key("averaged, nearest stable", color=GREY, linewidth=3.2, alpha=0.5)]
    page = Page(7.6, 2.2 * rows + 0.2, "One period of the settled motions: averaged against integrated", [study(result)], keys)
    panels = page.subplots(rows, columns, sharey=True)
    for i, (axes, m) in enumerate(zip(panels.ravel(), chosen)):
        t, integrated, nearest = aligned(result, m)
        turns = t * m.omega / (2 * np.pi)
        for q, colour in zip(names, (VERMILLION, BLUE)):
            if nearest:
                axes.plot(turns, nearest[q], color=colour, linewidth=3.6, alpha=0.3)
            axes.plot(turns, integrated[q], color=colour, linewidth=1.3)
        axes.axhline(0, color="#e4e4e4", linewidth=0.7, zorder=0)
        axes.set_xlim(0, turns[-1])
        axes.set_title(m.title(i), loc="left", fontsize=9)
    finish_sheet(panels, len(chosen), r"$t/T$, $T = 2\pi/\omega$", label("displacement", chosen[0].series.units[names[0]]))
    return "time", page.finish()


# --- starts from rest ------------------------------------------------------------------------------------------------------

def starts(result):
    """For the last start listed: the motion from rest on, and the spectrum of what it settles to."""
    runs = ordered(result.group("verification/transients").groups)
    if not runs:
        return None
    last = runs[-1].attributes["start"]
    chosen = [r for r in runs if r.attributes["start"] == last]
    names = leading(chosen)
    unit = chosen[0].units[names[0]]
    page = Page(7.8, 1.75 * len(chosen) + 0.3, f"From rest at {without_zeros(last)}{'' if unit == '-' else ' ' + unit}: time series, and spectra after "
                "settling", [study(result)],
                [marker_key(symbol(q), "os"[i], color=(VERMILLION, BLUE)[i], markersize=5) for i, q in enumerate(names)])
    panels = page.subplots(len(chosen), len(names) + 1, gridspec_kw={"width_ratios": [1.25] * len(names) + [1]})
    for row, run in zip(panels, chosen):
        omega, number = run.attributes["omega"], int(re.search(r"\d+$", run.path).group())
        turns = run.column("t") * omega / (2 * np.pi)
        for axes, q, colour in zip(row, names, (VERMILLION, BLUE)):
            axes.plot(turns, run.column(q), color=colour, linewidth=0.6)
            axes.set_xlim(0, turns[-1])
            axes.set_ylabel(label(symbol(q), unit))
        multiple = int(run.attributes["multiple"])
        settled = ("period T" if multiple == 1 else f"period {multiple}T") if run.attributes["motion"] == "periodic" else run.attributes["motion"]
        row[0].set_title(rf"$\omega$ = {omega:g} rad/s, settles to {settled}", loc="left")
        draw_spectrum(row[-1], result.group(f"verification/spectra/run{number}"), names)
    for axes in panels[-1, :-1]:
        axes.set_xlabel(r"$t/T$")
    panels[-1, -1].set_xlabel(r"frequency / $\omega$")
    return "starts", page.finish()


def without_zeros(start):
    """Of many coordinates only those away from zero are named."""
    parts = start.split(", ")
    return start if len(parts) <= 2 else ", ".join(p for p in parts if float(p.split("=")[1]) != 0.0) or "zero"


def draw_spectrum(axes, table, names):
    h = table.column("harmonic")
    top = 10.0 ** np.ceil(np.log10(1.2 * max(max(np.max(table.column(q)) for q in names), 1e-300)))
    floor = top * 10.0 ** -DECADES
    for q, marker, colour, shift in zip(names, "os", (VERMILLION, BLUE), (-0.05, 0.05)):
        seen = table.column(q) > floor
        axes.vlines(h[seen] + shift, floor, table.column(q)[seen], color=colour, linewidth=1.1)
        axes.plot(h[seen] + shift, table.column(q)[seen], linestyle="none", marker=marker, markersize=3.4, color=colour)
    axes.set_yscale("log")
    axes.set_xlim(-0.3, 4.3)
    axes.set_ylim(floor, top)
    axes.set_xticks(np.arange(0, 4.1, 1))
    axes.set_xticks(np.arange(0, 4.1, 0.5), minor=True)
    axes.set_ylabel(label("amplitude", table.units[names[0]]))
    axes.grid(True, axis="y", color="#ececec", linewidth=0.6)
    axes.set_axisbelow(True)
