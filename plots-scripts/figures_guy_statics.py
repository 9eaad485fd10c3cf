"""Figures of a guy-statics result: horizontal tension against displacement, reactions of groups of guys, chains of lumped masses."""
import numpy as np
from matplotlib.ticker import MaxNLocator

from figures_common import (BLUE, DASHES, GREEN, GREY, INK, PURPLE, VERMILLION, Page, letter, line_key, number)

DOTS = (0, (1.0, 1.6))


def figures(result):
    return [made for made in (force(result), groups(result), lumped(result)) if made]


def guy_words(result):
    """Tension, sag and what is unusual, for a line under a title."""
    guy, study = result.group("guy").columns, result.group("study").attributes
    words = [rf"$H$ = {number(guy['horizontal_tension'] / 1e3, 4)} kN", rf"$l$ = {study['guy.horizontal_span']:g} m",
             rf"$h$ = {study['guy.rise']:g} m", rf"$wl/2H$ = {number(guy['r'])}", rf"$\lambda^2$ = {number(guy['irvine_lambda2'])}"]
    if study.get("condition.ice_mass_per_length", 0) > 0:
        words.append(f"ice {study['condition.ice_mass_per_length']:g} kg/m")
    if study.get("condition.temperature_change", 0) != 0:
        words.append(f"{study['condition.temperature_change']:+g} K".replace("-", "−"))
    if study.get("outcome") != "complete":
        words.append("partial result")
    return ", ".join(w.replace(" ", "\u00a0") for w in words)


def force(result):
    """H against the displacement of the mast's end, tangent, taut wire; below, what the first-order form misses."""
    curve, guy = result.group("curve"), result.group("guy").columns
    exact, first = curve.group("exact"), curve.group("first_order")
    if not exact or not first:
        return None
    d, H = exact.column("displacement"), exact.column("horizontal_tension") / 1e3
    legend = [line_key("elastic catenary", color=BLUE, linewidth=1.8), line_key("first-order form", color=VERMILLION, linewidth=1.3, linestyle=DASHES),
              line_key("tangent at rest", color=INK, linewidth=1.0, linestyle=DOTS), line_key("taut wire", color=GREY, linewidth=0.9)]
    page = Page(6.6, 5.0, "Horizontal tension against the displacement of the mast's end", [guy_words(result), "The unstressed length stays."], legend)
    (top,), (low,) = page.subplots(2, 1, gridspec_kw={"height_ratios": [2.3, 1]})
    top.plot(d, H, color=BLUE, linewidth=1.8, zorder=3)
    top.plot(d, first.column("horizontal_tension") / 1e3, color=VERMILLION, linewidth=1.3, linestyle=DASHES, zorder=4)
    H0 = float(guy["horizontal_tension"]) / 1e3
    limits = (0.0, 1.06 * H.max())
    for slope, style in ((guy["modulus"], {"color": INK, "linewidth": 1.0, "linestyle": DOTS}), (guy["taut_modulus"], {"color": GREY, "linewidth": 0.9})):
        top.plot(d, H0 + float(slope) / 1e3 * d, zorder=2, **style)
    top.plot([0], [H0], "o", color=INK, markersize=4.5, zorder=5)
    top.set(ylim=limits, xlim=(d[0], d[-1]), ylabel=r"$H$ [kN]")
    low.plot(d, 100 * (first.column("horizontal_tension") / exact.column("horizontal_tension") - 1), color=VERMILLION, linewidth=1.3, linestyle=DASHES)
    low.plot(d, 100 * (first.column("modulus") / exact.column("modulus") - 1), color=GREEN, linewidth=1.3)
    low.axhline(0, color=GREY, linewidth=0.6)
    low.set(xlim=(d[0], d[-1]), xlabel="displacement away from the anchor [m]", ylabel="first-order\nerror [%]")
    low.legend(handles=[line_key(r"$H$", color=VERMILLION, linewidth=1.3, linestyle=DASHES), line_key(r"$dH/dl$", color=GREEN, linewidth=1.3)],
               loc="best", ncol=2)
    return "force", page.finish()


def groups(result):
    """Reaction of the group against the displacement of the held point, a column of panels for each of the first three directions."""
    parts = sorted(result.group("groups").groups.values(), key=lambda g: g.attributes["direction_deg"])[:3]
    if not parts:
        return None
    azimuths = ", ".join(f"{a:g}" for a in parts[0].attributes["azimuths_deg"])
    legend = [line_key("full geometry", color=BLUE, linewidth=1.8), line_key("spans only, as in the literature", color=VERMILLION, linewidth=1.3, linestyle=DASHES),
              line_key("tangent at rest", color=INK, linewidth=1.0, linestyle=DOTS)]
    if any(np.max(np.abs(p.column("reaction_across"))) > 1e-6 * np.max(np.abs(p.column("reaction"))) for p in parts):
        legend.append(line_key("across the displacement", color=PURPLE, linewidth=1.2))
    page = Page(2.7 * len(parts) + 1.0, 5.0, "Reaction of the guys of a level against the displacement of the mast",
                [guy_words(result), f"Anchors at azimuths {azimuths} degrees. Below, the reaction over the displacement."], legend)
    axes = page.subplots(2, len(parts), sharey="row", sharex=True, gridspec_kw={"height_ratios": [1.25, 1]})
    for k, part in enumerate(parts):
        reactions(axes[0, k], part, len(legend) > 3)
        axes[0, k].set_title(f"{letter(k)} towards {part.attributes['direction_deg']:g} degrees")
        secants(axes[1, k], part)
        axes[1, k].set_xlabel("displacement [m]")
        axes[1, k].xaxis.set_major_locator(MaxNLocator(5, prune="both"))
    axes[0, 0].set_ylabel("reaction [kN]")
    axes[1, 0].set_ylabel("reaction over\ndisplacement [kN/m]")
    return "groups", page.finish()


def reactions(panel, part, across):
    d = part.column("displacement")
    panel.plot(d, part.column("reaction") / 1e3, color=BLUE, linewidth=1.8, zorder=3)
    panel.plot(d, part.column("reaction_axial") / 1e3, color=VERMILLION, linewidth=1.3, linestyle=DASHES, zorder=4)
    panel.plot(d, part.attributes["tangent"] / 1e3 * d, color=INK, linewidth=1.0, linestyle=DOTS, zorder=2)
    if across:
        panel.plot(d, part.column("reaction_across") / 1e3, color=PURPLE, linewidth=1.2, zorder=2)
    panel.axhline(0, color=GREY, linewidth=0.5)
    panel.axvline(0, color=GREY, linewidth=0.5)
    panel.set_xlim(d[0], d[-1])


def secants(panel, part):
    """Reaction over displacement, with the tangent where the displacement vanishes."""
    d = part.column("displacement")
    near = np.abs(d) < 1e-6 * np.max(np.abs(d))
    for name, tangent, style in (("reaction", "tangent", {"color": BLUE, "linewidth": 1.8}),
                                 ("reaction_axial", "tangent_axial", {"color": VERMILLION, "linewidth": 1.3, "linestyle": DASHES})):
        secant = np.where(near, part.attributes[tangent], part.column(name) / np.where(near, 1.0, d))
        panel.plot(d, secant / 1e3, **style)
    panel.axhline(part.attributes["tangent"] / 1e3, color=INK, linewidth=1.0, linestyle=DOTS)


def lumped(result):
    """Distance from the chord of the catenary, the funicular polygon and the hung chain."""
    parts, curve = result.group("lumped"), result.group("static_curve")
    if not parts.groups or not curve:
        return None
    end = np.array([curve.column("x")[-1], curve.column("y")[-1]])
    chord = np.hypot(*end)

    def along_and_below(group):
        x, y = group.column("x"), group.column("y")
        return (x * end[0] + y * end[1]) / chord, (y * end[0] - x * end[1]) / chord

    styles = (("funicular", BLUE, "s", "funicular polygon"), ("hung", VERMILLION, "o", "hung masses"))
    legend = [line_key("elastic catenary", color=INK, linewidth=1.8)]
    legend += [line_key(words, color=colour, marker=marker, markersize=4.5, linewidth=1.1) for name, colour, marker, words in styles if name in parts.groups]
    tensions = ", ".join(f"{words} {parts.groups[name].attributes['horizontal_tension'] / 1e3:.2f}" for name, _, _, words in styles if name in parts.groups)
    page = Page(6.6, 3.3, "Chains of lumped masses beside the guy", [guy_words(result), f"Horizontal tension [kN]: {tensions}."], legend)
    panel = page.subplots()[0, 0]
    panel.plot(*along_and_below(curve), color=INK, linewidth=1.8, zorder=3)
    for name, colour, marker, _ in styles:
        if name in parts.groups:
            panel.plot(*along_and_below(parts.groups[name]), color=colour, marker=marker, markersize=4.5, linewidth=1.1, zorder=4)
    panel.set(xlabel="along the chord from the anchor [m]", ylabel="from the chord [m]", xlim=(0, chord))
    panel.set_ylim(top=0)
    return "lumped", page.finish()
