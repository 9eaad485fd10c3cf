"""Figure of a `mode-convergence` study: threshold and peak against the number of modes, one line for each treatment of the stretching."""
import numpy as np

from figures_common import BLUE, VERMILLION, Page, letter, line_key, number, study_words
from result_file import ResultError

STYLE = {"galerkin": (VERMILLION, "s", "uneven tension (galerkin)"), "quasi-static": (BLUE, "o", "uniform tension (quasi-static)")}


def figures(result):
    if not result.group("convergence").rows():
        raise ResultError("holds nothing to draw: the run ended before its first model")
    return [convergence(result)]


def convergence(result):
    table, a = result.group("convergence"), result.group("study").attributes
    names = [n for n in STYLE if np.any(table.column("longitudinal") == n)]
    harmonic = int(a["peak.harmonic"])
    panels = (("threshold", "threshold [m]", "least support amplitude that starts whirling"),
              ("threshold_omega", r"$\omega$ [rad/s]", "its frequency"),
              ("peak", "amplitude [m]", rf"planar peak at {harmonic}$\omega$, $U$ = {a['peak.amplitude']:g} m, $x/L$ = {a['peak.station']:g}"),
              ("peak_omega", r"$\omega$ [rad/s]", "its frequency"))
    words = study_words(result, "Lowest modes of each plane", varied="support_motion.amplitude")
    page = Page(6.6, 4.6, "Whirling threshold and planar peak against the number of modes", [words + ".", sentence(table, names)],
                [line_key(STYLE[n][2], color=STYLE[n][0], marker=STYLE[n][1], markersize=4.5, linewidth=1.4) for n in names])
    for k, (axes, (column, unit, title)) in enumerate(zip(page.subplots(2, 2).flat, panels)):
        for n in names:
            rows = table.column("longitudinal") == n
            axes.plot(table.column("modes")[rows], table.column(column)[rows], color=STYLE[n][0], marker=STYLE[n][1], markersize=4.5,
                      linewidth=1.4)
        axes.set_title(f"{letter(k)} {title}", loc="left", fontsize=8.5)
        axes.set_xlabel("modes in each plane")
        axes.set_ylabel(unit)
        axes.set_xticks(sorted(set(table.column("modes"))))
        axes.margins(y=0.12)
        axes.ticklabel_format(axis="y", useOffset=False)
    return "convergence", page.finish()


def sentence(table, names):
    """How far one mode of each plane is off the richest model, and the two treatments from each other."""
    parts, richest = [], {}
    for n in names:
        rows = table.column("longitudinal") == n
        modes, threshold = table.column("modes")[rows], table.column("threshold")[rows]
        first, last = threshold[np.argmin(modes)], threshold[np.argmax(modes)]
        richest[n] = last
        if np.isfinite(first) and np.isfinite(last):
            parts.append(f"{STYLE[n][2].split(' (')[0]}: {number(100 * (first / last - 1), 2)} % at {int(min(modes))}")
    text = "Threshold off the richest model: " + ", ".join(parts) + "." if parts else ""
    if len(richest) == 2 and all(np.isfinite(list(richest.values()))):
        g, q = richest["galerkin"], richest["quasi-static"]
        text += f" The two treatments differ by {number(100 * (q / g - 1), 2)} %."
    return text
