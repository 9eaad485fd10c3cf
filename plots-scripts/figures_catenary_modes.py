"""Figures of a catenary-modes result: mode shapes in and out of plane, frequencies against the sag parameter."""
import numpy as np

from catenary_parts import cable_words, displaced, in_order, moved, scalar, sentence
from figures_common import BLUE, CYCLE, DASHES, GREEN, GREY, INK, VERMILLION, Page, letter, line_key, number
from result_file import ResultError


def figures(result):
    found = [("modes", modes(result)), ("tension", tension(result)), ("sag", sag(result)), ("short-waves", short_waves(result))]
    found = [(name, figure) for name, figure in found if figure is not None]
    if not found:
        raise ResultError(f"holds nothing to draw: {lacking(result)}")
    return found


def lacking(result):
    if result.group("study").attributes.get("outcome") != "complete":
        return "the run ended before its first mode"
    if result.group("modes"):
        return "it has frequencies but no shapes of modes (modes.points is 0) and no sweep over the sag"
    return "it has no modes (modes.in_plane and modes.out_of_plane are 0) and no sweep over the sag"


# --- shapes ----------------------------------------------------------------------------------------------------------------

MOST = 6  # modes drawn in each plane
TALL = 1.5  # height over span from which modes in plane stand side by side in tall panels
LARGEST = 0.08  # of the cable's size, displacement drawn


def modes(result):
    """The cable at rest and moved by each of its first modes."""
    planes = [(p, in_order(result.group(f"shapes/{p}"), "mode")[:MOST]) for p in ("in_plane", "out_of_plane")]
    planes = [(p, [(int(mode), result.group(f"shapes/{p}/{name}")) for mode, name in names]) for p, names in planes if names]
    if not planes:
        return None
    line = planes[0][1][0][1]
    width, height = np.ptp(line.column("x")), np.ptp(line.column("y"))
    tall = height > TALL * width
    rows = [(p, shapes[i:i + n]) for p, shapes in planes for n in [6 if tall and p == "in_plane" else 3] for i in range(0, len(shapes), n)]
    heights = [3.4 if tall and p == "in_plane" else 1.65 for p, _ in rows]
    page = Page(9.6 if tall else 7.2, sum(heights), "Modes of a hanging cable", [sentence(result, cable_words(result))],
                mode_keys(planes, height > width))
    grid = page.figure.add_gridspec(len(rows), 6, height_ratios=heights)
    for r, (plane, shapes) in enumerate(rows):
        wide = 1 if tall and plane == "in_plane" else 2
        for k, (mode, table) in enumerate(shapes):
            axes = page.figure.add_subplot(grid[r, wide * k:wide * (k + 1)])
            title = mode_title(result.group(f"modes/{plane}"), mode, table)
            axes.set_title(title.replace(", ", "\n") if wide == 1 else title, loc="left", fontsize=8.5)
            if plane == "in_plane":
                draw_in_plane(axes, table, LARGEST * max(width, height))
            else:
                draw_lateral(axes, table)
            if wide == 1 and k > 0:
                axes.set_ylabel("")
    return page.finish()


def mode_keys(planes, high):
    shown = {p: [table for _, table in shapes] for p, shapes in planes}
    inside = [longitudinal(t) for t in shown.get("in_plane", [])]
    keys = [line_key("at rest", color=GREY, linewidth=0.9)]
    if inside:
        size = "height" if high else "span"
        keys.append(line_key(f"in plane, largest displacement {100 * LARGEST:g} % of the {size}", color=BLUE, linewidth=1.5))
    if any(inside):
        keys.append(line_key("longitudinal: U drawn across the cable", color=GREEN, linewidth=1.5))
    if "out_of_plane" in shown:
        keys.append(line_key("out of plane, W along the cable", color=VERMILLION, linewidth=1.5))
    return keys


def mode_title(modes_table, mode, shape):
    i = mode - 1
    kind = "longitudinal" if longitudinal(shape) else modes_table.column("kind")[i]
    return f"{mode}: {number(modes_table.column('frequency')[i], 4)} Hz, {kind}"


def longitudinal(shape):
    """Most of the motion, by its mean square, is along the cable."""
    return "U" in shape.columns and np.mean(shape.column("U") ** 2) > np.mean(shape.column("V") ** 2)


def draw_in_plane(axes, table, scale):
    axes.plot(table.column("x"), table.column("y"), color=GREY, linewidth=0.9)
    axes.plot(*moved(table, ("U", "V"), scale), color=BLUE, linewidth=1.5)
    if longitudinal(table):
        draw_across(axes, table, scale)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("x [m]", labelpad=1)
    axes.set_ylabel("y [m]", labelpad=1)


ARROW = {"arrowstyle": "->", "color": INK, "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 6}


def draw_across(axes, table, scale):
    """U as an ordinate square to the cable, and inside it arrows the way the cable moves."""
    U = table.column("U")
    x, y = displaced(table, 0 * U, U, scale)
    axes.plot(x, y, color=GREEN, linewidth=1.2)
    around = [np.concatenate([a, table.column(c)[::-1]]) for a, c in ((x, "x"), (y, "y"))]
    axes.fill(*around, color=GREEN, alpha=0.15, linewidth=0)
    tails, heads = (np.array(displaced(table, part * U, 0.5 * U, scale)).T for part in (-0.6, 0.6))
    for i in np.linspace(0, len(U) - 1, 14).astype(int)[1:-1:2]:
        if abs(U[i]) > 0.3:
            axes.annotate("", xy=heads[i], xytext=tails[i], arrowprops=ARROW)


def draw_lateral(axes, table):
    axes.axhline(0, color=GREY, linewidth=0.9)
    axes.plot(table.column("s"), table.column("W"), color=VERMILLION, linewidth=1.5)
    axes.set_ylim(-1.15, 1.15)
    axes.set_xlabel("s [m]", labelpad=1)
    axes.set_ylabel("W [m]", labelpad=1)


def tension(result):
    """Dynamic tension along the cable of the modes in plane."""
    names = in_order(result.group("shapes/in_plane"), "mode")[:4]
    if not names:
        return None
    table = result.group("modes/in_plane")
    titles = [mode_title(table, int(m), result.group(f"shapes/in_plane/{name}")) for m, name in names]
    keys = [line_key(title, color=CYCLE[k], linewidth=1.5) for k, title in enumerate(titles)]
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
