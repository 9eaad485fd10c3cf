"""Figures of a guy-modes result: transverse modes beside the string's, modes of the full problem, frequencies against tension."""
import numpy as np

from figures_common import (BLUE, DASHES, GREEN, GREY, INK, VERMILLION, Page, letter, line_key, number)
from figures_guy_statics import guy_words


def figures(result):
    return [made for made in (transverse(result), full(result), scan(result)) if made]


def transverse(result):
    """Normalised modes of linear tension and of the string; the last panels show the highest modes of the file."""
    table, shapes = result.group("modes/transverse"), result.group("modes/transverse_shapes")
    if not table or not shapes:
        return None
    count = table.rows()
    chosen = list(range(1, count + 1)) if count <= 4 else [1, 2, count - 1, count]
    legend = [line_key("linear tension, Bessel functions", color=BLUE, linewidth=1.7), line_key("string with the mean tension", color=VERMILLION, linewidth=1.2, linestyle=DASHES)]
    page = Page(6.8, 2.2 * -(-len(chosen) // 2), "Normalised transverse modes of the guy and of a string", [guy_words(result)], legend)
    axes = page.subplots(-(-len(chosen) // 2), 2, sharex=True, sharey=True)
    sigma = shapes.column("sigma")
    for k, (panel, i) in enumerate(zip(axes.flat, chosen)):
        panel.plot(sigma, shapes.column(f"guy_{i}"), color=BLUE, linewidth=1.7)
        panel.plot(sigma, shapes.column(f"string_{i}"), color=VERMILLION, linewidth=1.2, linestyle=DASHES)
        panel.axhline(0, color=GREY, linewidth=0.5)
        w, s = table.column("omega")[i - 1], table.column("omega_string")[i - 1]
        panel.set_title(f"{letter(k)} mode {i}: {number(w, 5)} and {number(s, 5)} rad/s")
        panel.set(xlim=(0, 1))
        if k % 2 == 0:
            panel.set_ylabel(r"$\phi_i$")
        if k >= len(chosen) - 2:
            panel.set_xlabel(r"$s/L$ from the anchor")
    for panel in list(axes.flat)[len(chosen):]:
        panel.set_visible(False)
    return "transverse", page.finish()


def full(result):
    """In-plane modes by their normal and tangential parts, out-of-plane modes, up to the fourth."""
    table, shapes = result.group("modes/in_plane"), result.group("modes/in_plane_shapes")
    out, out_shapes = result.group("modes/out_of_plane"), result.group("modes/out_of_plane_shapes")
    if not (table and shapes and out and out_shapes):
        return None
    count = min(table.rows(), 4)
    legend = [line_key("across the guy, in plane", color=BLUE, linewidth=1.7), line_key("along the guy, ten times", color=GREEN, linewidth=1.3),
              line_key("out of plane", color=VERMILLION, linewidth=1.2, linestyle=DASHES)]
    page = Page(6.8, 2.2 * -(-count // 2), "Modes of the full linear problem, both ends held", [guy_words(result)], legend)
    axes = page.subplots(-(-count // 2), 2, sharex=True, sharey=True)
    for k, (panel, i) in enumerate(zip(axes.flat, range(1, count + 1))):
        sigma, z = shapes.column("sigma"), out_shapes.column(f"z_{i}")
        normal, along = shapes.column(f"normal_{i}"), shapes.column(f"tangential_{i}")
        peak = normal[np.argmax(np.abs(normal))]
        sign = np.sign(peak) if peak else 1.0
        panel.plot(sigma, sign * normal, color=BLUE, linewidth=1.7, zorder=3)
        panel.plot(sigma, 10 * sign * along, color=GREEN, linewidth=1.3, zorder=2.5)
        panel.plot(sigma, z, color=VERMILLION, linewidth=1.2, linestyle=DASHES, zorder=4)
        panel.axhline(0, color=GREY, linewidth=0.5)
        panel.set_title(f"{letter(k)} mode {i}: {number(table.column('omega')[i - 1], 5)}, {number(out.column('omega')[i - 1], 5)} rad/s")
        panel.set(xlim=(0, 1), ylim=(-1.15, 1.15))
        if k % 2 == 0:
            panel.set_ylabel("displacement")
        if k >= count - 2:
            panel.set_xlabel(r"$s/L_0$ from the anchor")
    for panel in list(axes.flat)[count:]:
        panel.set_visible(False)
    return "full", page.finish()


def scan(result):
    """Frequencies over the string's first against tension: the symmetric modes climb through the others as the guy slackens."""
    table = result.group("scan")
    if not table:
        return None
    H, w1 = table.column("horizontal_tension") / 1e3, table.column("omega_string")
    count = sum(name.startswith("in_plane_") for name in table.columns)
    legend = [line_key("in plane", color=BLUE, linewidth=1.5), line_key("out of plane", color=VERMILLION, linewidth=1.1, linestyle=DASHES)]
    page = Page(6.6, 4.2, "Frequencies against tension, in units of the string's first", [guy_words(result), r"Vertical lines: $\lambda^2 = 4\pi^2$ (where the "
                "first two in-plane modes meet for a level guy) and this guy's tension."], legend)
    panel = page.subplots()[0, 0]
    for i in range(1, count + 1):
        panel.plot(H, table.column(f"in_plane_{i}") / w1, color=BLUE, linewidth=1.5, zorder=3)
        panel.plot(H, table.column(f"out_of_plane_{i}") / w1, color=VERMILLION, linewidth=1.1, linestyle=DASHES, zorder=4)
    lam = table.column("irvine_lambda2")
    if lam.min() < 4 * np.pi ** 2 < lam.max():
        panel.axvline(np.exp(np.interp(-np.log(4 * np.pi ** 2), -np.log(lam), np.log(H))), color=GREY, linewidth=0.8)
    panel.axvline(float(result.group("guy").columns["horizontal_tension"]) / 1e3, color=INK, linewidth=0.8, linestyle=(0, (1, 1.6)))
    panel.set(xscale="log", xlabel=r"$H$ [kN]", ylabel=r"$\omega_i/\omega_1$", xlim=(H[0], H[-1]), ylim=(0, min(count, 6) + 0.7))
    ticks = [v * 10.0 ** e for e in range(-3, 7) for v in (1, 2, 4, 6) if H[0] <= v * 10.0 ** e <= H[-1]]
    panel.set_xticks(ticks, [f"{t:g}" for t in ticks])
    panel.set_xticks([], minor=True)
    return "scan", page.finish()
