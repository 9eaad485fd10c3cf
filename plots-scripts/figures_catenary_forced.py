"""Figures of a catenary-forced result: resonance diagram, motion along the cable, largest and smallest tension over a period."""
import numpy as np

from catenary_parts import cable_words, in_order, moved, scalar, sentence
from figures_common import BLUE, CYCLE, DASHES, GREEN, GREY, INK, PURPLE, VERMILLION, Page, letter, line_key, number


def figures(result):
    found = [("resonance", resonance(result)), ("along", along(result)), ("shape", shape(result))]
    return [(name, figure) for name, figure in found if figure is not None]


def end_words(result):
    a = result.group("study").attributes
    parts = []
    for direction in ("tangential", "normal", "out_of_plane", "horizontal", "vertical"):
        amplitudes = np.ravel(a.get(f"end_motion.{direction}", []))
        if len(amplitudes):
            parts.append(f"{direction.replace('_', ' ')} {', '.join(number(x) for x in amplitudes)} m")
    return f"{a.get('end_motion.end', 'upper')} end moved: {'; '.join(parts)}"


def resonance(result):
    table = result.group("resonance")
    if not table.columns:
        return None
    natural = result.group("natural")
    keys = [line_key("largest dynamic tension along the cable", color=BLUE, linewidth=1.5),
            line_key("at the upper end", color=VERMILLION, linewidth=1.1, linestyle=DASHES),
            line_key("least static tension", color=GREEN, linewidth=1.1),
            line_key("largest normal displacement", color=PURPLE, linewidth=1.4),
            line_key("natural frequency in plane", color=GREY, linewidth=0.8, linestyle=(0, (1, 1.5)))]
    page = Page(6.8, 4.8, "Response of a hanging cable to motion of its end, first harmonic", [cable_words(result), sentence(result, end_words(result))], keys)
    top, bottom = page.subplots(2, 1, sharex=True)[:, 0]
    omega = table.column("omega")
    top.plot(omega, table.column("tension") / 1e3, color=BLUE, linewidth=1.5)
    top.plot(omega, table.column("tension_upper") / 1e3, color=VERMILLION, linewidth=1.1, linestyle=DASHES)
    level = smallest_static(result)
    top.axhline(level / 1e3, color=GREEN, linewidth=1.1)
    top.set_yscale("log")
    top.set_ylabel("dynamic tension [kN]")
    bottom.plot(omega, table.column("V"), color=PURPLE, linewidth=1.4)
    bottom.set_ylim(bottom=0)
    bottom.set_ylabel("V [m]")
    bottom.set_xlabel(r"$\omega$ [rad/s]")
    for axes, k in ((top, 0), (bottom, 1)):
        axes.set_title(f"{letter(k)} {('tension', 'normal displacement')[k]}", loc="left")
        axes.margins(x=0)
        axes.grid(True, color="#ececec", linewidth=0.6)
        for w, plane in zip(natural.columns.get("omega", []), natural.columns.get("plane", [])):
            if plane == "in_plane":
                axes.axvline(w, color=GREY, linewidth=0.8, linestyle=(0, (1, 1.5)))
    return page.finish()


def smallest_static(result):
    c = result.group("cable").columns
    inside = scalar(c, "xi_lower") < 0 < scalar(c, "xi_upper")
    return scalar(c, "horizontal_tension") if inside else scalar(c, "lower_tension")


def along(result):
    """Displacements, slope and tension along the cable, one column a frequency."""
    runs = in_order(result.group("motions"), "w")[:3]
    if not runs:
        return None
    keys = [line_key("tangential U", color=BLUE, linewidth=1.4), line_key("normal V", color=VERMILLION, linewidth=1.4),
            line_key("dynamic tension, first harmonic", color=INK, linewidth=1.4),
            line_key("static tension", color=GREY, linewidth=1.1),
            line_key("largest and smallest over a period, all harmonics", color=GREEN, linewidth=1.1, linestyle=DASHES)]
    page = Page(3.5 * max(len(runs), 2), 6.0, "Motion and tension along the cable", [cable_words(result), sentence(result, end_words(result))], keys)
    panels = page.subplots(3, len(runs), sharex=True)
    for j, (omega, name) in enumerate(runs):
        table, whole = result.group(f"motions/{name}/h1"), result.group(f"motions/{name}/envelope")
        s = table.column("s")
        panels[0, j].plot(s, table.column("U"), color=BLUE, linewidth=1.4)
        panels[0, j].plot(s, table.column("V"), color=VERMILLION, linewidth=1.4)
        panels[1, j].plot(s, table.column("tension") / 1e3, color=INK, linewidth=1.4)
        panels[2, j].plot(s, whole.column("static_tension") / 1e3, color=GREY, linewidth=1.1)
        for column in ("total_max", "total_min"):
            panels[2, j].plot(s, whole.column(column) / 1e3, color=GREEN, linewidth=1.1, linestyle=DASHES)
        panels[0, j].set_title(f"{letter(j)} {number(omega, 4)} rad/s", loc="left")
        panels[2, j].set_xlabel("s [m]")
        for axes in panels[:, j]:
            axes.margins(x=0)
            axes.grid(True, color="#ececec", linewidth=0.6)
    for axes, words in zip(panels[:, 0], ("amplitude [m]", "dynamic tension [kN]", "tension [kN]")):
        axes.set_ylabel(words)
    return page.finish()


def shape(result):
    """The cable at eight instants of a period, first harmonic."""
    runs = in_order(result.group("motions"), "w")[:3]
    if not runs:
        return None
    span = scalar(result.group("cable").columns, "span")
    largest = max(np.max(np.hypot(t.column("U"), t.column("V"))) for t in (result.group(f"motions/{n}/h1") for _, n in runs))
    scale = min(1.0, 0.12 * span / largest) if largest > 0 else 1.0
    scale = 0.08 * span / largest if largest > 0 and largest < 0.02 * span else scale
    keys = [line_key("at rest", color=GREY, linewidth=1.2), line_key(f"eight instants of a period, displacements {number(scale, 2)} times", color=BLUE, linewidth=0.9)]
    page = Page(3.5 * max(len(runs), 2), 2.6, "The cable as it moves, first harmonic", [cable_words(result), sentence(result, end_words(result))], keys)
    for j, (axes, (omega, name)) in enumerate(zip(page.subplots(1, len(runs))[0], runs)):
        table = result.group(f"motions/{name}/h1")
        for k in range(8):
            draw_instant(axes, table, scale, 2 * np.pi * k / 8)
        axes.plot(table.column("x"), table.column("y"), color=GREY, linewidth=1.2)
        axes.set_aspect("equal", adjustable="datalim")
        axes.set_title(f"{letter(j)} {number(omega, 4)} rad/s", loc="left")
        axes.set_xlabel("x [m]")
        axes.set_ylabel("y [m]")
    return page.finish()


def draw_instant(axes, table, scale, phase):
    values = {c: table.column(c) * np.cos(phase + table.column(f"{c}_phase")) for c in ("U", "V")}
    axes.plot(*moved(Instant(table, values), ("U", "V"), scale), color=BLUE, linewidth=0.9, alpha=0.35 + 0.65 * np.cos(phase / 2) ** 2)


class Instant:
    """A table with two columns replaced."""

    def __init__(self, table, values):
        self.table, self.values = table, values

    def column(self, name):
        return self.values[name] if name in self.values else self.table.column(name)
