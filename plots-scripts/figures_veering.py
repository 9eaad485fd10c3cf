"""Figures of a veering result: frequencies against flexibility for each h/b, gaps, hybrid modes about the closest approach."""
import numpy as np

from catenary_parts import in_order, scalar, sentence
from figures_common import BLUE, GREY, INK, VERMILLION, Page, letter, line_key, marker_key, number
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap

PARITY = LinearSegmentedColormap.from_list("parity", [BLUE, "#bbbbbb", VERMILLION])


def figures(result):
    found = [("frequencies", frequencies(result)), ("hybrid", hybrid(result))]
    return [(name, figure) for name, figure in found if figure is not None]


def words(result):
    c = result.group("cable").columns
    return rf"$b/2a$ = {number(scalar(c, 'half_width'), 4)}, horizontal tension {number(scalar(c, 'horizontal_tension') / 1e3, 4)} kN, frequencies in plane."


def frequencies(result):
    fans = in_order(result.group("fan"), "h")
    if not fans:
        return None
    table = result.group("approaches")
    keys = [line_key("symmetric", color=BLUE, linewidth=1.6), line_key("hybrid", color="#bbbbbb", linewidth=1.6),
            line_key("antisymmetric", color=VERMILLION, linewidth=1.6)]
    if len(table.columns.get("what", [])):
        keys += [marker_key("crossing", "o", markersize=6, markerfacecolor="white", markeredgecolor=INK),
                 line_key("closest approach (gap below 25 %)", color=INK, linewidth=1.0, marker="_", markersize=6)]
    columns = min(3, len(fans))
    rows = -(-len(fans) // columns)
    page = Page(2.4 * columns + 0.4, 2.7 * rows, "Frequencies of a hanging cable as it softens", [sentence(result, words(result))], keys)
    panels = page.subplots(rows, columns, sharex=True, sharey=True).ravel()
    for k, (axes, (h, name)) in enumerate(zip(panels, fans)):
        draw_fan(axes, result.group(f"fan/{name}"))
        draw_approaches(axes, table, h)
        axes.set_title(f"{letter(k)} h/b = {h:g}", loc="left")
        axes.set_xscale("log")
        axes.grid(True, color="#ececec", linewidth=0.6)
        if k + columns >= len(fans):
            axes.set_xlabel(r"$\kappa = H/EA$")
            axes.tick_params(labelbottom=True)
        if k % columns == 0:
            axes.set_ylabel(r"$\omega$ [rad/s]")
    for axes in panels[len(fans):]:
        axes.axis("off")
    return page.finish()


def draw_fan(axes, table):
    x = table.column("flexibility")
    names = [c for c in table.columns if c.startswith("omega")]
    low, high = np.inf, -np.inf
    for name in names:
        y, odd = table.column(name), table.column(name.replace("omega", "odd"))
        points = np.column_stack([x, y])
        pieces = LineCollection(np.stack([points[:-1], points[1:]], axis=1), cmap=PARITY, linewidths=1.6, zorder=3)
        pieces.set_array(0.5 * (odd[:-1] + odd[1:]))
        pieces.set_clim(0, 1)
        axes.add_collection(pieces)
        low, high = min(low, np.min(y)), max(high, np.max(y))
    axes.set_xlim(x[0], x[-1])
    axes.set_ylim(0.9 * low, 1.03 * high)


def draw_approaches(axes, table, h):
    for i in range(table.rows()):
        if abs(table.column("height_over_span")[i] - h) > 1e-12:
            continue
        x, low, high = (table.column(c)[i] for c in ("flexibility", "omega_lower", "omega_upper"))
        if table.column("what")[i] == "crossing":
            axes.plot(x, 0.5 * (low + high), "o", markersize=6, markerfacecolor="none", markeredgecolor=INK, zorder=5)
        elif table.column("gap")[i] < 0.25:
            axes.plot([x, x], [low, high], color=INK, linewidth=1.0, marker="_", markersize=6, zorder=5)


def hybrid(result):
    """Both modes about the closest approach of the least inclined cable that has one."""
    names = in_order(result.group("hybrid"), "h")
    if not names:
        return None
    h, name = names[min(1, len(names) - 1)]
    stages = [(s, result.group(f"hybrid/{name}/{s}")) for s in ("stiffer", "closest", "softer")]
    keys = [line_key("lower mode", color=BLUE, linewidth=1.5), line_key("upper mode", color=VERMILLION, linewidth=1.5)]
    mode = int(stages[0][1].attributes["lower_mode"])
    page = Page(7.0, 2.5, f"Modes {mode} and {mode + 1} exchange their shapes, h/b = {h:g}",
                [sentence(result, words(result) + " Normal displacement along the span; the odd share of each mode stands in the panel.")], keys)
    for k, (axes, (stage, table)) in enumerate(zip(page.subplots(1, 3, sharey=True)[0], stages)):
        axes.axhline(0, color=GREY, linewidth=0.7)
        axes.plot(table.column("x"), table.column("V_lower"), color=BLUE, linewidth=1.5)
        axes.plot(table.column("x"), table.column("V_upper"), color=VERMILLION, linewidth=1.5)
        axes.set_title(rf"{letter(k)} {stage}, $\kappa$ = {number(table.attributes['flexibility'])}", loc="left")
        for y, key, colour in ((0.14, "odd_lower", BLUE), (0.05, "odd_upper", VERMILLION)):
            axes.text(0.03, y, f"odd {table.attributes[key]:.2f}", transform=axes.transAxes, color=colour, fontsize=8.5)
        axes.set_ylim(-1.5, 1.1)
        axes.set_xlim(0, 1)
        axes.set_xlabel("x / b")
    page.figure.axes[0].set_ylabel("V")
    return page.finish()
