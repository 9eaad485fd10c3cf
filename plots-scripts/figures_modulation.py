"""Figure of the averaged equations in time beside the demodulated motion: amplitudes over time, and the way in the plane of (u, v)."""
import re

import numpy as np

from figures_common import BLUE, GREEN, INK, ORANGE, PURPLE, VERMILLION, Page, label, letter, line_key, study_words

COLOURS = (VERMILLION, BLUE, GREEN, PURPLE, ORANGE, INK)
MOST_RUNS = 6
SMALL = 0.02     # of the largest amplitude: not drawn


def modulation(result):
    """For each start at rest: amplitudes integrated (solid) and averaged (dashed), and beside them their way in the plane."""
    group = result.group("verification/modulation")
    if not group or not group.groups:
        return None
    runs = sorted(group.groups.values(), key=lambda g: int(re.search(r"\d+$", g.path).group()))
    shown = runs[:MOST_RUNS]
    names = sorted({n for run in shown for n in amplitudes(run)})
    colour = {n: COLOURS[i % len(COLOURS)] for i, n in enumerate(names)}
    left = len(runs) - len(shown)
    page = Page(7.4, 1.9 * len(shown) + 0.5, "Averaged equations in time against the integrated motion",
                [study_words(result, "amplitudes demodulated over one period" + (f"; {left} more runs in the file" if left else ""))],
                [line_key("integrated", color=INK), line_key("averaged", color=INK, linestyle="--")] +
                [line_key(words(n), color=colour[n]) for n in names])
    axes = page.subplots(len(shown), 2, gridspec_kw={"width_ratios": [2.4, 1]})
    for i, (row, run) in enumerate(zip(axes, shown)):
        turns = run.column("t") * run.attributes["omega"] / (2 * np.pi)
        for n in amplitudes(run):
            for prefix, style in (("", "-"), ("averaged_", "--")):
                u, v = parts(run, prefix + n)
                row[0].plot(turns, np.hypot(u, v), color=colour[n], linestyle=style, linewidth=1.1)
                row[1].plot(u, v, color=colour[n], linestyle=style, linewidth=0.9)
        unit = run.units[next(c for c in run.columns if c.endswith("_u"))]
        row[0].set_title(f"{letter(i)} $\\omega$ = {run.attributes['omega']:g} rad/s from {run.attributes['start']}: "
                         f"difference {run.attributes['difference']:.3f}", loc="left", fontsize=8)
        row[0].set_ylabel(label("$|Z|$", unit))
        row[0].set_xlim(0, turns[-1] if len(turns) else 1)
        row[0].set_ylim(bottom=0)
        row[1].set_aspect("equal", adjustable="datalim")
        row[1].set_ylabel(label("$v$", unit))
        for panel in row:
            panel.grid(True, color="#ececec", linewidth=0.6)
            panel.tick_params(labelsize=7.5)
    axes[-1, 0].set_xlabel(r"$t/T$, $T = 2\pi/\omega$")
    axes[-1, 1].set_xlabel(label("$u$", unit))
    return "modulation", page.finish()


def amplitudes(run):
    """Names of the amplitudes that are not small, without u and v."""
    names = [c[:-2] for c in run.columns if c.endswith("_u") and not c.startswith("averaged_")]
    size = {n: max(np.max(np.hypot(*parts(run, p + n)), initial=0.0) for p in ("", "averaged_")) for n in names}
    top = max(size.values(), default=0.0)
    return [n for n in names if size[n] > SMALL * top]


def parts(run, name):
    u = run.column(name + "_u")
    return u, run.column(name + "_v") if name + "_v" in run.columns else np.zeros_like(u)


def words(name):
    """q1_h2 as $q_1$ at 2 omega."""
    found = re.fullmatch(r"([a-z]+)(\d*)_h([0-9.]+)", name)
    if not found:
        return name
    stem, number, k = found.groups()
    symbol = f"${stem}_{{{number}}}$" if number else f"${stem}$"
    return f"{symbol} mean" if float(k) == 0 else rf"{symbol} at {'' if float(k) == 1 else k}$\omega$"
