"""Figures of a guy-stiffness result: dynamic guy modulus with its closed forms and their errors, the matrix, convergence, longitudinal motion."""
import numpy as np

from figures_common import (BLUE, DASHES, GREEN, GREY, INK, ORANGE, PURPLE, SKY, VERMILLION, Page, letter, line_key, marker_key, number)
from figures_guy_statics import guy_words

FORMS = {
    "classical": (VERMILLION, DASHES, "classical (Kolousek, Davenport)"), "completed": (GREEN, DASHES, "completed"),
    "completed_massless": (SKY, DASHES, "completed, no longitudinal inertia"), "sarvi": (PURPLE, "-", "Sarvi (5.122)"),
    "sarvi_modal": (ORANGE, (0, (1.0, 1.4)), "Sarvi, eight modes"),
}


def figures(result):
    return [made for made in (modulus(result), matrix(result), convergence(result), longitudinal(result)) if made]


def broken(x, y, limit):
    """The curve with its jumps through infinity cut: a line from one edge to the other would be a lie."""
    y = np.array(y, dtype=float)
    jump = np.flatnonzero((np.abs(np.diff(y)) > limit) & (y[:-1] * y[1:] < 0))
    return np.insert(x, jump + 1, np.nan), np.insert(y, jump + 1, np.nan)


def words_of(result):
    a = result.group("stiffness/horizontal").attributes
    return guy_words(result) + f", $c/m$\u00a0=\u00a0{number(a['damping_rate'])}\u00a01/s"


def modulus(result):
    """Real and imaginary part of K over the static modulus against frequency, full problem and closed forms, and the errors."""
    table = result.group("stiffness/horizontal")
    if not table:
        return None
    x, static = table.column("omega_ratio"), table.attributes["static"]
    forms = [name for name in FORMS if f"{name}_re" in table.columns]
    legend = [line_key("full linear problem", color=BLUE, linewidth=2.0)]
    legend += [line_key(FORMS[f][2], color=FORMS[f][0], linestyle=FORMS[f][1], linewidth=1.2) for f in forms]
    page = Page(7.2, 7.4, "Dynamic guy modulus: horizontal force over horizontal motion of the mast's end",
                [words_of(result), f"Static modulus {number(static / 1e3, 5)} kN/m, taut wire {number(table.attributes['taut'] / 1e3, 5)} kN/m; "
                 "where a closed form is missing in the middle panel, its imaginary part is negative: it would give out energy."], legend)
    (top,), (middle,), (low,) = page.subplots(3, 1, sharex=True, gridspec_kw={"height_ratios": [1.5, 1, 1.1]})
    real = table.column("full_re") / static
    high = 1.15 * max(np.percentile(real, 96), 1.4)
    low_end = min(1.1 * np.percentile(real, 2), -0.15 * high)
    for name, (colour, dashes, _) in [("full", (BLUE, "-", ""))] + [(f, FORMS[f]) for f in forms]:
        width, order = (2.0, 2.5) if name == "full" else (1.2, 3)
        top.plot(*broken(x, table.column(f"{name}_re") / static, high - low_end), color=colour, linestyle=dashes, linewidth=width, zorder=order)
        imaginary = table.column(f"{name}_im") / static
        middle.plot(x, np.where(imaginary > 0, imaginary, np.nan), color=colour, linestyle=dashes, linewidth=width, zorder=order)
        if name != "full":
            low.plot(x, table.column(f"error_{name}"), color=colour, linestyle=dashes, linewidth=width, zorder=order)
    poles = result.group("poles_and_zeros")
    for kind, marker in (("pole", "x"), ("zero", "o")):
        at = [w for w, d, t in zip(poles.column("omega_ratio"), poles.column("direction"), poles.column("type")) if d == "horizontal" and t == kind]
        top.plot(at, np.zeros(len(at)), marker, color=INK, markersize=4.5, markerfacecolor="none", zorder=5, linestyle="none")
    top.axhline(0, color=GREY, linewidth=0.5)
    top.legend(handles=[marker_key("poles", "x", color=INK), marker_key("zeros", "o", color=INK, markerfacecolor="none")], loc="upper right", ncol=2,
               frameon=True, facecolor="white", edgecolor="none", framealpha=0.9)
    top.set(ylim=(low_end, high), ylabel=r"Re $K/K_{\mathrm{static}}$", xlim=(0, x[-1]))
    middle.set_ylabel(r"Im $K/K_{\mathrm{static}}$")
    full_im = table.column("full_im") / static
    if np.any(full_im > 0):
        middle.set(yscale="log", ylim=(0.3 * np.min(full_im[full_im > 0]), 3 * np.max(full_im)))
    else:
        middle.text(0.5, 0.5, "no damping, no imaginary part", transform=middle.transAxes, ha="center", va="center", color=GREY)
    if forms:
        low.set(yscale="log", ylim=(1e-4, 1e1))
    low.set(xlabel=r"$\Omega = p/\omega_1$ of the mean-tension string", ylabel="error of the\nclosed forms")
    return "modulus", page.finish()


def matrix(result):
    """Moduli of the entries of the stiffness matrix of one guy, and of the level if there is one."""
    table, horizontal, level = (result.group(f"stiffness/{n}") for n in ("matrix", "horizontal", "level"))
    if not table:
        return None
    x = table.column("omega_ratio")

    def size(group, name):
        return np.hypot(group.column(f"{name}_re"), group.column(f"{name}_im")) / 1e3

    legend = [line_key("horizontal", color=BLUE, linewidth=1.5), line_key("vertical", color=GREEN, linewidth=1.5),
              line_key("horizontal-vertical", color=PURPLE, linewidth=1.0, linestyle=DASHES), line_key("out of plane", color=VERMILLION, linewidth=1.2)]
    page = Page(6.8, 4.9 if level else 3.0, "Stiffness matrix of the mast's end", [words_of(result)], legend)
    axes = page.subplots(2 if level else 1, 1, sharex=True)
    first = axes[0, 0]
    first.plot(x, size(horizontal, "full"), color=BLUE, linewidth=1.5)
    first.plot(x, size(table, "yy"), color=GREEN, linewidth=1.5)
    first.plot(x, size(table, "xy"), color=PURPLE, linewidth=1.0, linestyle=DASHES)
    first.plot(x, size(table, "zz"), color=VERMILLION, linewidth=1.2)
    first.set(yscale="log", ylabel=r"$|K|$ [kN/m]", xlim=(0, x[-1]))
    if level:
        first.set_title("(a) one guy")
        second = axes[1, 0]
        second.plot(x, size(level, "XX"), color=BLUE, linewidth=1.5)
        if np.max(np.abs(size(level, "XX") / size(level, "YY") - 1)) > 1e-6:
            second.plot(x, size(level, "YY"), color=BLUE, linewidth=1.2, linestyle=DASHES)
        second.plot(x, size(level, "ZZ"), color=GREEN, linewidth=1.5)
        second.set(yscale="log", ylabel=r"$|K|$ [kN/m]")
        azimuths = ", ".join(f"{a:g}" for a in level.attributes["azimuths_deg"])
        second.set_title(f"(b) level of guys with anchors at azimuths {azimuths} degrees")
    axes[-1, 0].set_xlabel(r"$\Omega = p/\omega_1$ of the mean-tension string")
    return "matrix", page.finish()


def convergence(result):
    table = result.group("convergence")
    if not table or table.rows() < 2:
        return None
    n = table.column("degree")
    legend = [line_key("Legendre-Galerkin, one eigenproblem for all frequencies", color=BLUE, marker="o", markersize=3.5, linewidth=1.2),
              line_key("Chebyshev collocation", color=VERMILLION, marker="s", markersize=3.5, linewidth=1.0, linestyle=DASHES)]
    page = Page(6.4, 3.2, "Spectral convergence of the full problem", [words_of(result), f"At {number(table.attributes['omega'], 4)} rad/s, against degree "
                f"{int(table.attributes['reference_degree'])}."], legend)
    panel = page.subplots()[0, 0]
    for name, style in (("galerkin", legend[0]), ("collocation", legend[1])):
        panel.plot(n, np.maximum(table.column(f"error_{name}"), 1e-17), color=style.get_color(), marker=style.get_marker(), markersize=3.5,
                   linestyle=style.get_linestyle(), linewidth=1.1)
    panel.set(yscale="log", xlabel="polynomial degree", ylabel=r"relative error of $K$", ylim=(1e-16, 1e3))
    return "convergence", page.finish()


def longitudinal(result):
    """Magnification of displacement and force, without damping and with the study's."""
    table = result.group("longitudinal")
    if not table:
        return None
    x = table.column("X") / np.pi
    legend = [line_key("no damping", color=BLUE, linewidth=1.5), line_key("modulus with the study's damping", color=VERMILLION, linewidth=1.2, linestyle=DASHES)]
    page = Page(6.8, 4.2, "Longitudinal motion of the guy as a bar, softened by its sag",
                [words_of(result), rf"$\alpha$ = {number(table.attributes['alpha'], 4)}, wave speed {number(table.attributes['wave_speed'], 5)} m/s; the full guy bends as it stretches."], legend)
    axes = page.subplots(2, 1, sharex=True)
    for k, (panel, name, words) in enumerate(((axes[0, 0], "displacement", "displacement, constant force"), (axes[1, 0], "force", "force, constant displacement"))):
        y = table.column(name)
        panel.plot(*broken(x, y, 10.0), color=BLUE, linewidth=1.5)
        panel.plot(x, table.column(f"{name}_damped"), color=VERMILLION, linewidth=1.2, linestyle=DASHES)
        panel.axhline(0, color=GREY, linewidth=0.5)
        panel.set_title(f"{letter(k)} {words}")
        panel.set(ylim=(-6, 6) if name == "displacement" else (-30, 30), ylabel="over static", xlim=(0, x[-1]))
    axes[1, 0].set_xlabel(r"$X/\pi = pL/\pi a$")
    return "longitudinal", page.finish()
