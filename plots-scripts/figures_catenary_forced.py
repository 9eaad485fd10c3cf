"""Figures of a catenary-forced result: resonance diagram, displacements and tension along the cable, the cable as it moves."""
import numpy as np
from matplotlib.ticker import MaxNLocator

from catenary_parts import cable_words, displaced, in_order, nonzero, scalar, sentence
from figures_common import BLUE, DASHES, GREEN, GREY, INK, ORANGE, PURPLE, VERMILLION, Page, letter, line_key, number
from result_file import ResultError

DISPLACEMENTS = {"U": ("tangential U", BLUE), "V": ("normal V", VERMILLION), "W": ("out of plane W", PURPLE)}
DOTS = (0, (1, 1.5))
MOST = 3  # frequencies drawn side by side


def figures(result):
    found = [("resonance", resonance(result)), ("along", along(result)), ("shape", shape(result))]
    found = [(name, figure) for name, figure in found if figure is not None]
    if not found:
        complete = result.group("study").attributes.get("outcome") == "complete"
        why = "every displacement and tension is zero" if complete else "the run ended before its first frequency"
        raise ResultError(f"holds nothing to draw: {why}")
    return found


def end_words(result):
    a = result.group("study").attributes
    parts = []
    for direction in ("tangential", "normal", "out_of_plane", "horizontal", "vertical"):
        amplitudes = np.ravel(a.get(f"end_motion.{direction}", []))
        if len(amplitudes):
            parts.append(f"{direction.replace('_', ' ')} {', '.join(number(x) for x in amplitudes)} m")
    return f"{a.get('end_motion.end', 'upper')} end moved: {'; '.join(parts)}"


def sentences(result, tension):
    """What is moved, why a tension is missing, and the cable."""
    a = result.group("study").attributes
    lateral = not nonzero(*(np.ravel(a.get(f"end_motion.{d}", [])) for d in ("tangential", "normal", "horizontal", "vertical")))
    words = end_words(result) + (". No dynamic tension: it is of second order in W." if lateral and not tension else "")
    return [sentence(result, words), cable_words(result)]


# --- resonance diagram -----------------------------------------------------------------------------------------------------

PANELS = [("dynamic tension", ("tension", "tension_upper", "tension_lower"), "in_plane"), ("normal displacement", ("V",), "in_plane"),
          ("displacement out of plane", ("W",), "out_of_plane")]  # title, columns, whose natural frequencies are marked


def resonance(result):
    """Against frequency: dynamic tension, largest normal displacement, largest displacement out of plane, those that are not zero."""
    table, natural = result.group("resonance"), result.group("natural")
    panels = [p for p in PANELS if table.columns and nonzero(*(table.column(c) for c in p[1]))]
    if not panels:
        return None
    shown = [c for _, columns, _ in panels for c in columns]
    keys = resonance_keys(shown) + natural_key(natural, [plane for _, _, plane in panels])
    page = Page(6.8, 2.3 * len(panels) + 0.2, "Response of a hanging cable to motion of its end, first harmonic",
                sentences(result, "tension" in shown), keys)
    rows = page.subplots(len(panels), 1, sharex=True)[:, 0]
    for k, (axes, (title, columns, plane)) in enumerate(zip(rows, panels)):
        draw_tension(axes, result) if "tension" in columns else draw_largest(axes, table, *columns)
        axes.set_title(f"{letter(k)} {title}", loc="left")
        axes.margins(x=0)
        axes.grid(True, color="#ececec", linewidth=0.6)
        for w in natural_of(natural, plane):
            axes.axvline(w, color=GREY, linewidth=0.8, linestyle=DOTS)
    rows[-1].set_xlabel(r"$\omega$ [rad/s]")
    rows[-1].tick_params(axis="x", pad=5)
    return page.finish()


def resonance_keys(shown):
    keys = []
    if "tension" in shown:
        keys += [line_key("largest along the cable", color=INK, linewidth=2.2, alpha=0.5),
                 line_key("at the upper end", color=ORANGE, linewidth=1.2, linestyle=DASHES),
                 line_key("at the lower end", color=BLUE, linewidth=1.2, linestyle=DOTS),
                 line_key("least static tension", color=GREEN, linewidth=1.1)]
    return keys + [line_key(f"largest {words}", color=colour, linewidth=1.4) for c, (words, colour) in DISPLACEMENTS.items() if c in shown]


def natural_key(natural, planes):
    """One entry; it says which panels mark which plane where there are both."""
    where = {p: [letter(k) for k, q in enumerate(planes) if q == p] for p in dict.fromkeys(planes) if natural_of(natural, p)}
    words = [p.replace("_", " ") + (f" in {', '.join(letters)}" if len(set(planes)) > 1 else "") for p, letters in where.items()]
    return [line_key(f"natural frequency {'; '.join(words)}", color=GREY, linewidth=0.8, linestyle=DOTS)] if words else []


def natural_of(natural, plane):
    return [w for w, p in zip(natural.columns.get("omega", []), natural.columns.get("plane", [])) if p == plane]


def draw_tension(axes, result):
    table = result.group("resonance")
    omega = table.column("omega")
    axes.plot(omega, table.column("tension") / 1e3, color=INK, linewidth=2.2, alpha=0.5)
    axes.plot(omega, table.column("tension_upper") / 1e3, color=ORANGE, linewidth=1.2, linestyle=DASHES)
    axes.plot(omega, table.column("tension_lower") / 1e3, color=BLUE, linewidth=1.2, linestyle=DOTS)
    axes.axhline(smallest_static(result) / 1e3, color=GREEN, linewidth=1.1)
    axes.set_yscale("log")
    axes.set_ylabel("dynamic tension [kN]")


def draw_largest(axes, table, column):
    axes.plot(table.column("omega"), table.column(column), color=DISPLACEMENTS[column][1], linewidth=1.4)
    axes.set_ylim(bottom=0)
    axes.set_ylabel(f"{column} [m]")


def smallest_static(result):
    c = result.group("cable").columns
    inside = scalar(c, "xi_lower") < 0 < scalar(c, "xi_upper")
    return scalar(c, "horizontal_tension") if inside else scalar(c, "lower_tension")


# --- along the cable -------------------------------------------------------------------------------------------------------

def along(result):
    """Displacements and tension along the cable, one column a frequency."""
    runs = in_order(result.group("motions"), "w")[:MOST]
    first, whole = ([result.group(f"motions/{name}/{part}") for _, name in runs] for part in ("h1", "envelope"))
    shown = [c for c in DISPLACEMENTS if nonzero(*(t.column(c) for t in first))]
    dynamic = nonzero(*(t.column("tension") for t in first))
    total = nonzero(*(t.column("total_max") - t.column("total_min") for t in whole))
    rows = [row for row, there in ((("amplitude [m]", lambda axes, j: draw_displacements(axes, first[j], shown)), shown),
                                   (("dynamic tension [kN]", lambda axes, j: draw_dynamic(axes, first[j])), dynamic),
                                   (("tension [kN]", lambda axes, j: draw_total(axes, whole[j])), total)) if there]
    if not rows:
        return None
    keys = [line_key(f"{DISPLACEMENTS[c][0]}, first harmonic", color=DISPLACEMENTS[c][1], linewidth=1.4) for c in shown]
    if dynamic:
        keys.append(line_key("dynamic tension, first harmonic", color=INK, linewidth=1.4))
    if total:
        keys += [line_key("static tension", color=GREY, linewidth=1.1),
                 line_key("largest and smallest over a period, all harmonics", color=GREEN, linewidth=1.1, linestyle=DASHES)]
    title = " and ".join(w for w, there in (("displacement", shown), ("tension", dynamic or total)) if there).capitalize()
    page = Page(3.5 * max(len(runs), 2), 2.0 * len(rows) + 0.3 * (len(rows) == 1), f"{title} along the cable",
                sentences(result, dynamic or total), keys)
    panels = page.subplots(len(rows), len(runs), sharex=True)
    for j, (omega, _) in enumerate(runs):
        for axes, (_, draw) in zip(panels[:, j], rows):
            draw(axes, j)
            axes.margins(x=0)
            axes.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 2.5, 5, 10]))
            axes.grid(True, color="#ececec", linewidth=0.6)
        panels[0, j].set_title(f"{letter(j)} {number(omega, 4)} rad/s", loc="left")
        panels[-1, j].set_xlabel("arc length from the lower end s [m]")
    for axes, (words, _) in zip(panels[:, 0], rows):
        axes.set_ylabel(words)
    return page.finish()


def draw_displacements(axes, table, shown):
    for c in shown:
        axes.plot(table.column("s"), table.column(c), color=DISPLACEMENTS[c][1], linewidth=1.4)
    axes.set_ylim(bottom=0)


def draw_dynamic(axes, table):
    axes.plot(table.column("s"), table.column("tension") / 1e3, color=INK, linewidth=1.4)


def draw_total(axes, table):
    axes.plot(table.column("s"), table.column("static_tension") / 1e3, color=GREY, linewidth=1.1)
    for column in ("total_max", "total_min"):
        axes.plot(table.column("s"), table.column(column) / 1e3, color=GREEN, linewidth=1.1, linestyle=DASHES)


# --- the cable as it moves -------------------------------------------------------------------------------------------------

PHASES = 2 * np.pi * np.arange(8) / 8


def shape(result):
    """The cable at eight instants of a period, all harmonics: seen from the side, and W along it."""
    runs = in_order(result.group("motions"), "w")[:MOST]
    runs = [(omega, result.group(f"motions/{name}")) for omega, name in runs]
    runs = [(omega, [(k, motion.group(h)) for k, h in in_order(motion, "h")]) for omega, motion in runs]
    runs = [(omega, harmonics) for omega, harmonics in runs if harmonics]
    tables = [t for _, harmonics in runs for _, t in harmonics]
    side, lateral = nonzero(*(t.column(c) for t in tables for c in "UV")), nonzero(*(t.column("W") for t in tables))
    if not side and not lateral:
        return None
    width, height = np.ptp(tables[0].column("x")), np.ptp(tables[0].column("y"))
    scale = scale_for(runs, max(width, height))
    heights = ([float(np.clip(3 * height / width + 0.7, 1.2, 3.6)) + 0.8] if side else []) + ([2.0] if lateral else [])
    keys = [line_key("at rest", color=GREY, linewidth=1.2)]
    if side:
        words = "true to scale" if scale == 1 else f"displacements times {number_plain(scale)}"
        keys.append(line_key(f"eight instants of a period from the side, {words}", color=BLUE, linewidth=0.9))
    if lateral:
        keys.append(line_key(f"out of plane at {'these instants' if side else 'eight instants of a period'}", color=PURPLE, linewidth=0.9))
    page = Page(3.5 * max(len(runs), 2), sum(heights), "The cable as it moves, all harmonics", sentences(result, True), keys)
    panels = page.subplots(len(heights), len(runs), gridspec_kw={"height_ratios": heights})
    for j, (omega, harmonics) in enumerate(runs):
        if side:
            draw_side(panels[0, j], harmonics, scale)
        if lateral:
            draw_lateral(panels[-1, j], harmonics)
        panels[0, j].set_title(f"{letter(j)} {number(omega, 4)} rad/s", loc="left")
    return page.finish()


def at_instant(harmonics, column, phase):
    return sum(t.column(column) * np.cos(k * phase + t.column(f"{column}_phase")) for k, t in harmonics)


def scale_for(runs, size):
    """1 where displacements in plane show at their size and fit, else to two digits what makes them."""
    largest = max(np.max(np.hypot(at_instant(h, "U", p), at_instant(h, "V", p))) for _, h in runs for p in PHASES)
    if largest == 0 or 0.02 * size <= largest <= 0.12 * size:
        return 1.0
    return float(f"{(0.08 if largest < 0.02 * size else 0.12) * size / largest:.2g}")


def number_plain(x):
    return f"{x:.0f}" if 10 <= x < 1e6 else number(x, 2)


def paleness(phase):
    return 0.35 + 0.65 * np.cos(phase / 2) ** 2


def draw_side(axes, harmonics, scale):
    line = harmonics[0][1]
    for phase in PHASES:
        axes.plot(*displaced(line, at_instant(harmonics, "U", phase), at_instant(harmonics, "V", phase), scale), color=BLUE, linewidth=0.9,
                  alpha=paleness(phase))
    axes.plot(line.column("x"), line.column("y"), color=GREY, linewidth=1.2)
    axes.set_aspect("equal", adjustable="datalim")
    axes.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 2.5, 5, 10]))
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")


def draw_lateral(axes, harmonics):
    line = harmonics[0][1]
    axes.axhline(0, color=GREY, linewidth=1.2)
    for phase in PHASES:
        axes.plot(line.column("s"), at_instant(harmonics, "W", phase), color=PURPLE, linewidth=0.9, alpha=paleness(phase))
    axes.margins(x=0)
    axes.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 2.5, 5, 10]))
    axes.set_xlabel("arc length from the lower end s [m]")
    axes.set_ylabel("W [m]")
