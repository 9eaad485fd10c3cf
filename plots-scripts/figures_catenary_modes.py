"""Figures of a catenary-modes result: mode shapes in and out of plane, frequencies against the sag parameter."""
import numpy as np

from catenary_parts import KINDS, cable_words, in_order, moved, scalar, sentence
from figures_common import BLUE, CYCLE, DASHES, GREY, INK, VERMILLION, Page, letter, line_key, number


def figures(result):
    found = [("modes", modes(result)), ("tension", tension(result)), ("sag", sag(result)), ("short-waves", short_waves(result))]
    return [(name, figure) for name, figure in found if figure is not None]


# --- shapes ----------------------------------------------------------------------------------------------------------------

MOST = 6  # modes drawn in each plane


def modes(result):
    """The cable at rest and moved by each of its first modes."""
    planes = [(p, in_order(result.group(f"shapes/{p}"), "mode")[:MOST]) for p in ("in_plane", "out_of_plane")]
    planes = [(p, names) for p, names in planes if names]
    if not planes:
        return None
    keys = [line_key("at rest", color=GREY, linewidth=0.9), line_key("in plane, largest displacement 8 % of the span", color=BLUE, linewidth=1.5),
            line_key("out of plane, W along the cable", color=VERMILLION, linewidth=1.5)]
    page = Page(7.2, 1.65 * sum(-(-len(n) // 3) for _, n in planes), "Modes of a hanging cable", [sentence(result, cable_words(result))], keys)
    panels = page.subplots(sum(-(-len(n) // 3) for _, n in planes), 3).ravel()
    used = 0
    for plane, names in planes:
        for mode, name in names:
            axes = panels[used]
            used += 1
            table = result.group(f"shapes/{plane}/{name}")
            (draw_in_plane if plane == "in_plane" else draw_lateral)(axes, table, scalar(result.group("cable").columns, "span"))
            axes.set_title(mode_title(result.group(f"modes/{plane}"), int(mode)), loc="left", fontsize=8.5)
        used = -(-used // 3) * 3
    for axes in panels:
        if not axes.lines:
            axes.axis("off")
    return page.finish()


def mode_title(table, mode):
    i = mode - 1
    return f"{mode}: {number(table.column('frequency')[i], 4)} Hz, {table.column('kind')[i]}"


def draw_in_plane(axes, table, span):
    axes.plot(table.column("x"), table.column("y"), color=GREY, linewidth=0.9)
    axes.plot(*moved(table, ("U", "V"), 0.08 * span), color=BLUE, linewidth=1.5)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("x [m]", labelpad=1)
    axes.set_ylabel("y [m]", labelpad=1)


def draw_lateral(axes, table, _):
    axes.axhline(0, color=GREY, linewidth=0.9)
    axes.plot(table.column("s"), table.column("W"), color=VERMILLION, linewidth=1.5)
    axes.set_ylim(-1.15, 1.15)
    axes.set_xlabel("s [m]", labelpad=1)
    axes.set_ylabel("W", labelpad=1)


def tension(result):
    """Dynamic tension along the cable of the modes in plane."""
    names = in_order(result.group("shapes/in_plane"), "mode")[:4]
    if not names:
        return None
    table = result.group("modes/in_plane")
    keys = [line_key(mode_title(table, int(m)), color=CYCLE[k], linewidth=1.5) for k, (m, _) in enumerate(names)]
    page = Page(6.6, 2.9, "Dynamic tension of modes whose largest displacement is 1 m", [sentence(result, cable_words(result))], keys)
    axes = page.subplots()[0, 0]
    axes.axhline(0, color=GREY, linewidth=0.7)
    for k, (_, name) in enumerate(names):
        shape = result.group(f"shapes/in_plane/{name}")
        axes.plot(shape.column("s"), shape.column("tension") / 1e3, color=CYCLE[k], linewidth=1.5)
    axes.set_xlabel("arc length from the lower end s [m]")
    axes.set_ylabel("tension [kN]")
    axes.margins(x=0)
    return page.finish()


# --- frequencies against sag -----------------------------------------------------------------------------------------------

def sag(result):
    """One row for each plane, one panel for each h/b."""
    planes = [(p, in_order(result.group(f"sweep/{p}"), "h")) for p in ("in_plane", "out_of_plane")]
    planes = [(p, names) for p, names in planes if names]
    if not planes:
        return None
    columns = max(len(names) for _, names in planes)
    cable = result.group("cable").columns
    here = scalar(cable, "height_difference") / scalar(cable, "span")
    keys = [line_key(f"{words} mode, inextensible cable", color=colour, linewidth=1.2)
            for words, colour in (("1st, 3rd, 5th", BLUE), ("2nd, 4th, 6th", VERMILLION))]
    if any("pendulum" in result.group(f"sweep/{p}/{n}").columns for p, names in planes for _, n in names):
        keys.append(line_key("rigid cable about its chord", color=INK, linewidth=1.0, linestyle=DASHES))
    if any(abs(h - here) < 1e-9 for _, names in planes for h, _ in names):
        keys.append(line_key("sag parameter of this study's cable", color=GREY, linewidth=0.8, linestyle=(0, (2, 2))))
    page = Page(max(4.5, 1.75 * columns), 2.6 * len(planes), "Natural frequencies against the sag of a hanging cable",
                [sentence(result, r"$\omega\,\sqrt{a/g}$ over $b/\sqrt{l^2-h^2}$: 1 is the taut string, 0 the cable that hangs straight down and up.")], keys)
    panels = page.subplots(len(planes), columns, sharex=True, sharey="row")
    k = 0
    for row, (plane, names) in zip(panels, planes):
        for axes, (h, name) in zip(row, names):
            draw_sag(axes, result.group(f"sweep/{plane}/{name}"))
            if abs(h - here) < 1e-9:
                axes.axvline(scalar(cable, "sag_parameter"), color=GREY, linewidth=0.8, linestyle=(0, (2, 2)))
            axes.set_title(f"{letter(k)} h/b = {h:g}", loc="left", fontsize=8.5)
            k += 1
        row[0].set_ylabel(plane.replace("_", " ") + r":  $\omega\,\sqrt{a/g}$")
    for axes in panels[-1]:
        axes.set_xlabel(r"$b/\sqrt{l^2-h^2}$")
    return page.finish()


def draw_sag(axes, table):
    x = table.column("sag_parameter")
    names = [c for c in table.columns if c.startswith("w")][:6]
    for i, name in enumerate(sorted(names, key=lambda n: int(n[1:]))):
        axes.plot(x, table.column(name), color=BLUE if i % 2 == 0 else VERMILLION, linewidth=1.2)
    if "pendulum" in table.columns:
        axes.plot(x, table.column("pendulum"), color=INK, linewidth=1.0, linestyle=DASHES)
    axes.set_ylim(0, 26)
    axes.set_xlim(x[0], x[-1])
    axes.grid(True, color="#ececec", linewidth=0.6)


def short_waves(result):
    """Level cable, in plane: frequencies and the asymptotic formula for short waves, and how far it is off."""
    if "h0" not in result.group("sweep/in_plane").groups:
        return None
    table = result.group("sweep/in_plane/h0")
    count = min(6, sum(name.startswith("asymptotic") for name in table.columns))
    if count == 0:
        return None
    keys = [line_key(f"mode {k + 1}", color=CYCLE[k], linewidth=1.4) for k in range(count)]
    keys.append(line_key("asymptotic", color=INK, linewidth=1.0, linestyle=DASHES))
    page = Page(7.2, 3.0, "Level cable, in plane: the asymptotic formula for short waves",
                [sentence(result, "Inextensible. The formula has no root for low modes of deep cables.")], keys)
    left, right = page.subplots(1, 2)[0]
    x = table.column("sag_parameter")
    for k in range(count):
        exact, formula = table.column(f"w{k + 1}"), table.column(f"asymptotic{k + 1}")
        left.plot(x, exact, color=CYCLE[k], linewidth=1.4)
        left.plot(x, formula, color=INK, linewidth=1.0, linestyle=DASHES)
        right.semilogy(x, np.abs(formula / exact - 1), color=CYCLE[k], linewidth=1.4)
    left.set_ylim(0, 26)
    left.set_ylabel(r"$\omega\,\sqrt{a/g}$")
    right.set_ylabel("relative error of the formula")
    for letter_index, axes in enumerate((left, right)):
        axes.set_xlim(x[0], x[-1])
        axes.set_xlabel(r"$b/\sqrt{l^2-h^2}$")
        axes.set_title(letter(letter_index), loc="left", fontsize=8.5)
        axes.grid(True, color="#ececec", linewidth=0.6)
    return page.finish()
