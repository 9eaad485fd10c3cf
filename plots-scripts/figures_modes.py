"""Figures of a `modes` study: shapes, cross-over diagram, graphical solution of the symmetric frequency equation."""
import numpy as np

from figures_common import (BLUE, GREEN, GREY, INK, ORANGE, PURPLE, VERMILLION, Page, Tag, letter, line_key, marker_key, number,
                            place_tags)
from result_file import ResultError


def figures(result):
    if not result.group("modes").rows():
        raise ResultError("holds nothing to draw: the run ended before its modes")
    return [made for made in (cross_over(result), shapes(result), antisymmetric(result), graphical(result), forms(result)) if made]


def scalar(result, name):
    return float(np.asarray(result.group("cable").column(name)))


def cable_words(result):
    return (rf"$\lambda^2$ = {number(scalar(result, 'lambda2'), 4)}, sag 1:{number(1 / scalar(result, 'sag_ratio'), 3)}, "
            rf"$T$ = {number(scalar(result, 'chord_tension') / 1000, 4)} kN.")


def cross_over(result):
    """b of every family against lambda^2, this cable's modes as dots."""
    table, modes = result.group("cross_over"), result.group("modes")
    if not table:
        return None
    lambda2, mine = table.column("lambda2"), scalar(result, "lambda2")
    page = Page(6.6, 4.1, "Cross-over diagram: in-plane frequencies against the cable's parameter",
                [cable_words(result) + " Symmetric and antisymmetric frequencies meet at "
                 r"$\lambda^2 = 4 n^2 \pi^2$; out of plane $\beta l = n \pi$."],
                [line_key("symmetric in plane", color=BLUE, linewidth=1.6), line_key("antisymmetric in plane", color=VERMILLION, linewidth=1.6),
                 line_key("out of plane", color=GREY, linewidth=0.9, linestyle=(0, (1, 1.5))),
                 marker_key("this cable", "o", markersize=6, color=INK)])
    axes = page.subplots()[0, 0]
    names = sorted(c for c in table.columns if c.startswith("symmetric"))
    top = len(names)
    for n in range(1, 2 * top + 1):
        axes.axhline(n, color=GREY, linewidth=0.9, linestyle=(0, (1, 1.5)), zorder=1.5)
    for n, name in enumerate(names, 1):
        axes.plot(lambda2, table.column(name) / np.pi, color=BLUE, linewidth=1.6, zorder=3)
        axes.plot(lambda2, 0 * lambda2 + 2 * n, color=VERMILLION, linewidth=1.6, zorder=2)
        at = (2 * n * np.pi)**2
        axes.plot(at, 2 * n, "s", markersize=4.5, markerfacecolor="white", markeredgecolor=INK, zorder=4)
    for b, family in zip(modes.column("frequency_number"), modes.column("family")):
        if family != "out of plane":
            axes.plot(mine, b / np.pi, "o", markersize=6, zorder=5, color=BLUE if family == "symmetric" else VERMILLION,
                      markeredgecolor=INK, markeredgewidth=0.8)
    axes.axvline(mine, color=INK, linewidth=0.6, zorder=1)
    axes.set_xscale("log")
    axes.set_xlim(lambda2[0], lambda2[-1])
    axes.set_ylim(0.8, 2 * top + 0.5)
    axes.set_xlabel(r"$\lambda^2$")
    axes.set_ylabel(r"$\beta l/\pi = \omega/\omega_1$ (out of plane)")
    figure = page.finish()
    place_tags(axes, [Tag(r"$4\pi^2$", [((2 * np.pi)**2, 2)], leader=False), Tag(r"$16\pi^2$", [((4 * np.pi)**2, 4)], leader=False)])
    return "cross-over", figure


def shapes(result):
    """Transverse and longitudinal shapes of the lowest modes in plane."""
    modes, group = result.group("modes"), result.group("shapes")
    chosen = [str(m) for m, f in zip(modes.column("mode"), modes.column("family")) if f != "out of plane" and group.group(str(m))][:4]
    if not chosen:
        return None
    page = Page(6.6, 4.4, "Lowest in-plane mode shapes", [cable_words(result) + " Longitudinal part on its own scale."],
                [line_key("transverse v", color=BLUE, linewidth=1.6), line_key("longitudinal u", color=VERMILLION, linewidth=1.3)])
    for k, (axes, name) in enumerate(zip(page.subplots(2, 2).flat, chosen)):
        about = group.group(name).attributes
        draw_shape(axes, group.group(name), f"{letter(k)} {name}, {about['family']}, {about['frequency']:.4g} Hz")
    return "shapes", page.finish()


def draw_shape(axes, shape, title):
    xi, u = shape.column("xi"), shape.column("longitudinal")
    axes.plot(xi, shape.column("transverse"), color=BLUE, linewidth=1.6)
    axes.axhline(0, color=GREY, linewidth=0.6)
    axes.set_xlim(0, 1)
    axes.set_ylim(-1.15, 1.15)
    axes.set_xlabel(r"$x/l$")
    axes.set_ylabel(r"$v$")
    other = axes.twinx()
    other.plot(xi, u, color=VERMILLION, linewidth=1.3)
    largest = max(np.max(np.abs(u)), 1e-12)
    other.set_ylim(-1.15 * largest, 1.15 * largest)
    other.set_ylabel(r"$u$", color=VERMILLION)
    other.tick_params(axis="y", colors=VERMILLION)
    axes.set_title(title, loc="left")


def antisymmetric(result):
    """Longitudinal components of the first two antisymmetric modes above their vertical ones, drawn like the source's figure 2."""
    group, ratio = result.group("shapes"), scalar(result, "sag_ratio")
    if not (group.group("z2") and group.group("z4")) or ratio == 0:
        return None
    page = Page(6.6, 3.6, "Longitudinal motion of the first two antisymmetric modes",
                ["Divided by the sag ratio and the transverse amplitude; the first has its largest values at the quarter spans and a local "
                 "minimum at midspan, the second zero with zero slope there."])
    panels = page.subplots(2, 2, sharex=True)
    for k, name in enumerate(("z2", "z4")):
        shape = group.group(name)
        xi = shape.column("xi")
        for axes, y, colour, words in ((panels[0, k], shape.column("longitudinal") / ratio, VERMILLION, r"$u\,l/d$"),
                                       (panels[1, k], shape.column("transverse"), BLUE, r"$v$")):
            axes.plot(xi, y, color=colour, linewidth=1.6)
            axes.axhline(0, color=GREY, linewidth=0.6)
            axes.set_xlim(0, 1)
            axes.set_ylabel(words)
        panels[0, k].set_title(f"{letter(k)} {name}: antisymmetric, order {k + 1}", loc="left")
        panels[1, k].set_xlabel(r"$x/l$")
    return "antisymmetric", page.finish()


def graphical(result):
    """tan x against x - 4 x^3/lambda^2, x = b/2, like the source's figure 3."""
    modes, mine = result.group("modes"), scalar(result, "lambda2")
    roots = [b / 2 for b, f in zip(modes.column("frequency_number"), modes.column("family")) if f == "symmetric"]
    roots = [x for x in roots if x < 2.6 * np.pi]
    values = [("4 π²", 4 * np.pi**2, GREEN), ("16 π²", 16 * np.pi**2, ORANGE), ("∞", np.inf, PURPLE)]
    page = Page(6.6, 4.0, r"Roots of $\tan(\beta l/2) = \beta l/2 - (4/\lambda^2)(\beta l/2)^3$",
                [cable_words(result) + " Circles: this cable's symmetric modes; one root in each branch of the tangent, none in the first."],
                [line_key(r"$\tan x$", color=INK, linewidth=1.1), line_key("this cable", color=BLUE, linewidth=1.6)]
                + [line_key(rf"$\lambda^2$ = {words}", color=colour, linewidth=1.2) for words, _, colour in values])
    axes = page.subplots()[0, 0]
    low, high = -14.0, 9.5
    for k in range(3):
        x = np.linspace((k - 0.5) * np.pi if k else 0, (k + 0.5) * np.pi, 800)[1:-1]
        axes.plot(x / np.pi, np.where(np.abs(np.tan(x)) < 60, np.tan(x), np.nan), color=INK, linewidth=1.1)
    for k in range(3):
        axes.axvline(k + 0.5, color=GREY, linewidth=0.5, linestyle=(0, (1, 2)))
    x = np.linspace(0, 2.6 * np.pi, 1200)
    for value, colour, width in [(mine, BLUE, 1.6)] + [(v, c, 1.2) for _, v, c in values]:
        axes.plot(x / np.pi, x - 4 * x**3 / value, color=colour, linewidth=width)
    for root in roots:
        y = root - 4 * root**3 / mine
        if low < y < high:
            axes.plot(root / np.pi, y, "o", markersize=5.5, markerfacecolor="white", markeredgecolor=BLUE, markeredgewidth=1.3, zorder=5)
    axes.set_xlim(0, 2.6)
    axes.set_ylim(low, high)
    axes.set_xlabel(r"$\beta l/2\pi$")
    axes.set_ylabel("both sides of the equation")
    return "roots", page.finish()


def multiple(x):
    return "" if np.isclose(x, 1) else f"{x:g}\\,"


def forms(result):
    """The first symmetric mode below, at and above the first cross-over, like the source's figure 4."""
    table = result.group("symmetric_forms")
    if not table:
        return None
    values = np.atleast_1d(table.attributes["lambda2"])
    words = ("no internal node", "tangent to the profile at its ends", "two internal nodes")
    page = Page(6.6, 2.5, "Forms of the first symmetric mode on both sides of the first cross-over", [])
    for k, axes in enumerate(page.subplots(1, 3, sharey=True)[0]):
        axes.plot(table.column("xi"), table.column(f"form{k + 1}"), color=BLUE, linewidth=1.6)
        axes.axhline(0, color=GREY, linewidth=0.6)
        axes.set_xlim(0, 1)
        axes.set_xlabel(r"$x/l$")
        axes.set_title(rf"{letter(k)} $\lambda^2 = {multiple(values[k] / np.pi**2)}\pi^2$" + f"\n{words[k]}", loc="left", fontsize=8.5)
    page.figure.axes[0].set_ylabel(r"$v$")
    return "symmetric", page.finish()
