"""Figures of a time integration: how motions begin, what they settle on, Poincare sections, sweeps with their jumps."""
import numpy as np
from matplotlib.ticker import MaxNLocator

from figures_common import BLUE, GREY, INK, VERMILLION, Page, letter, line_key, marker_key, number, study_words
from integration_figures import (axis_label, coordinate_keys, coordinates, draw_lines, draw_orbit, motion_words, parameter_label, style, symbol,
                                 text_column)

FLOOR = 1e-3  # of amplitudes drawn
ROWS = 5      # of motions on a page


def figures(result):
    made = [beginnings(result), *motions(result), sections(result), sweeps(result)]
    return [f for f in made if f]


def study(result, varied="omega"):
    return study_words(result, "time integration", varied=varied)


# --- beginnings ------------------------------------------------------------------------------------------------------------

def beginnings(result):
    """q(t) from every start."""
    runs = result.group("integrate/runs")
    rows = [k for k in range(runs.rows()) if result.group(f"integrate/run{k + 1}")][:8]
    if not rows:
        return None
    names = coordinates(result.group(f"integrate/run{rows[0] + 1}"))
    keys = [line_key(f"{symbol(q)}$(t)$", color=style(i)[0], linestyle=style(i)[1], linewidth=1.2) for i, q in enumerate(names)]
    page = Page(7.0, 1.35 * len(rows) + 0.35, "How the motions begin", [study(result)], keys)
    panels = page.subplots(len(rows), 1, sharex=False)[:, 0]
    for i, (axes, k) in enumerate(zip(panels, rows)):
        table = result.group(f"integrate/run{k + 1}")
        for j, q in reversed(list(enumerate(names))):
            colour, line, _ = style(j)
            axes.plot(table.column("t"), table.column(q), color=colour, linestyle=line, linewidth=0.9)
        settled = text_column(runs, "attractor", k)
        axes.set_title(rf"{letter(i)} $\omega$ = {table.attributes['omega']:.5g} rad/s, start {table.attributes['start']}: "
                       + (f"settles on {settled}" if settled else text_column(runs, "motion", k)), loc="left", fontsize=9)
        axes.set_ylabel(f"{', '.join(symbol(q) for q in names)} [{table.units[names[0]]}]")
        axes.set_xlim(0, table.column("t")[-1])
    panels[-1].set_xlabel("$t$ [s]")
    return "beginnings", page.finish()


# --- motions ---------------------------------------------------------------------------------------------------------------

def motions(result):
    """Settled motions, a row each: time, orbit with stroboscopic points, spectrum."""
    table = result.group("integrate/attractors")
    found = []
    for first in range(0, table.rows(), ROWS):
        rows = range(first, min(first + ROWS, table.rows()))
        name = "motions" if table.rows() <= ROWS else f"motions-{first // ROWS + 1}"
        found.append((name, motions_page(result, table, rows)))
    return found


def motions_page(result, table, rows):
    names = coordinates(result.group(f"integrate/{text_column(table, 'attractor', rows[0])}/series"))
    keys = coordinate_keys(names)
    keys.append(marker_key("stroboscopic points", "o", markersize=5, markerfacecolor="white", markeredgecolor=VERMILLION,
                           markeredgewidth=1.3))
    page = Page(7.6, 2.15 * len(rows) + 0.2, "Settled motions: in time, in the plane of two states, as a spectrum", [study(result)], keys)
    panels = page.subplots(len(rows), 3, gridspec_kw={"width_ratios": [1.25, 1, 1.25]})
    for i, row in enumerate(rows):
        draw_motion(result, table, row, panels[i], names, i)
    panels[-1, 0].set_xlabel(r"$\omega t/2\pi$")
    panels[-1, 2].set_xlabel(r"frequency / $\omega$")
    return page.finish()


def draw_motion(result, table, row, panels, names, i):
    name = text_column(table, "attractor", row)
    group = result.group(f"integrate/{name}")
    series, omega = group.group("series"), table.column("omega")[row]
    periods = max(4.0, 2 * table.column("multiple")[row])
    time, orbit, spectrum = panels
    turns = series.column("t") * omega / (2 * np.pi)
    for j, q in reversed(list(enumerate(names))):
        colour, line, _ = style(j)
        if table.column("multiple")[row] > 0:  # a periodic record, repeated
            copies = int(np.ceil(periods / table.column("multiple")[row])) + 1
            x = np.concatenate([turns + k * table.column("multiple")[row] for k in range(copies)])
            y = np.tile(series.column(q), copies)
        else:
            periods, x, y = 12.0, turns, series.column(q)
        time.plot(x[x <= periods], y[x <= periods], color=colour, linestyle=line, linewidth=1.1)
    time.set_xlim(0, periods)
    time.set_ylabel(f"{', '.join(symbol(q) for q in names)} [{series.units[names[0]]}]", labelpad=1)
    time.yaxis.set_major_locator(MaxNLocator(nbins=5, steps=[1, 2, 5, 10]))
    mirror = text_column(table, "mirror", row)
    # A title per column: a long one would run into the labels of the row above.
    titles = (rf"{letter(i)} {name}, $\omega$ = {omega:.5g} rad/s", motion_words(text_column(table, "motion", row), table.column("multiple")[row]),
              f"mirror image: {mirror}" if mirror else "")
    for axes, title in zip(panels, titles):
        axes.set_title(title or " ", loc="left", fontsize=9)
    states = plane_of(series, names)
    draw_orbit(orbit, series, group.group("section"), states)
    orbit.set_xlabel(axis_label(series, states[0]), labelpad=1)
    orbit.set_ylabel(axis_label(series, states[1]), labelpad=1)
    draw_lines(spectrum, group.group("spectrum"), group.group("amplitude_spectrum"), names, FLOOR, series.units[names[0]])


def plane_of(series, names):
    """(q1, q2), or a coordinate and its velocity where the other one rests."""
    extent = [np.ptp(series.column(q)) for q in names]
    if len(names) > 1 and min(extent[:2]) > 1e-6 * max(extent[:2]):
        return names[0], names[1]
    moving = names[int(np.argmax(extent))]
    return moving, f"{moving}'"


# --- sections --------------------------------------------------------------------------------------------------------------

def sections(result):
    """Stroboscopic points of motions without period."""
    table = result.group("integrate/attractors")
    rows = [k for k in range(table.rows()) if table.column("multiple")[k] == 0][:6]
    if not rows:
        return None
    columns = min(len(rows), 2)
    lines = -(-len(rows) // columns)
    phase = float(result.group("study").attributes.get("integrate.section_phase_deg", 0.0))
    keys = [marker_key("stroboscopic points", "o", markersize=3, color=VERMILLION), marker_key("their mean", "+", markersize=7, color=BLUE)]
    page = Page(7.0 if columns > 1 else 5.2, 3.2 * lines, f"Poincaré sections at excitation phase {phase:g}°", [study(result)], keys)
    panels = page.subplots(lines, columns)
    for i, (axes, row) in enumerate(zip(panels.ravel(), rows)):
        section = result.group(f"integrate/{text_column(table, 'attractor', row)}/section")
        names = coordinates(section)
        moving = names[int(np.argmax([np.ptp(section.column(q)) for q in names]))]
        axes.plot(section.column(moving), section.column(f"{moving}'"), linestyle="none", marker="o", markersize=2.0, color=VERMILLION, markeredgewidth=0)
        axes.plot(np.mean(section.column(moving)), np.mean(section.column(f"{moving}'")), marker="+", color=BLUE, markersize=7)
        axes.grid(True, color="#ececec", linewidth=0.6)
        axes.set_axisbelow(True)
        axes.set_xlabel(axis_label(section, moving))
        axes.set_ylabel(axis_label(section, f"{moving}'"))
        second = table.column("second_frequency")[row]
        exponent = rf"$\lambda$ = {number(table.column('lyapunov')[row], 2)} ± {number(table.column('lyapunov_error')[row], 1)} 1/s"
        axes.set_title(f"{letter(i)} {text_column(table, 'attractor', row)}, {text_column(table, 'motion', row)}\n{exponent}"
                       + (rf", second frequency {second:.5f} $\omega$" if second > 0 else ""), loc="left", fontsize=9)
    for axes in panels.ravel()[len(rows):]:
        axes.set_visible(False)
    return "sections", page.finish()


# --- sweeps ----------------------------------------------------------------------------------------------------------------

WAYS = {"up": (">", BLUE), "down": ("<", VERMILLION)}


def sweeps(result):
    """Root mean square of every coordinate while the parameter goes up and down; jumps and changes of kind marked."""
    tables = {way: result.group(f"sweep/{way}") for way in WAYS if result.group(f"sweep/{way}").rows()}
    if not tables:
        return None
    parameter = str(result.group("study").attributes.get("sweep.parameter", "omega"))
    first = next(iter(tables.values()))
    names = [c[:-len("_rms")] for c in first.columns if c.endswith("_rms")]
    keys = [marker_key(f"sweep {way}", WAYS[way][0], markersize=5, color=WAYS[way][1], markerfacecolor="none") for way in tables]
    keys += [line_key("jump", color=INK, linewidth=1.1), line_key("change of kind", color=GREY, linewidth=1.0, linestyle=(0, (1, 1.5)))]
    page = Page(7.0, 2.5 * len(names) + 0.3, "Slow sweeps of the settled motion",
                ["Filled: period of several excitation periods. Numbers: middle of a jump's bracket.", study(result, parameter)], keys)
    panels = page.subplots(len(names), 1, sharex=True)[:, 0]
    for axes, q in zip(panels, names):
        for way, table in tables.items():
            marker, colour = WAYS[way]
            kinds = table.column("multiple")
            axes.plot(table.column(parameter), table.column(f"{q}_rms"), linestyle="none", marker=marker, markersize=4.5, color=colour,
                      markerfacecolor="none", markeredgewidth=0.9, zorder=3)
            double = kinds > 1
            axes.plot(table.column(parameter)[double], table.column(f"{q}_rms")[double], linestyle="none", marker=marker, markersize=4.5,
                      color=colour, zorder=3.1)
        axes.set_ylabel(f"{symbol(q)} rms [{first.units[f'{q}_rms']}]")
        axes.margins(y=0.12)
        axes.grid(True, color="#f0f0f0", linewidth=0.6)
        axes.set_axisbelow(True)
    for way, table in tables.items():
        mark_transitions(panels, result.group(f"sweep/transitions_{way}"), names, way)
    panels[-1].set_xlabel(parameter_label(parameter, first.units.get(parameter, "")))
    return "sweep", page.finish()


def mark_transitions(panels, marks, names, way):
    for k in range(marks.rows()):
        at, jump = 0.5 * (marks.column("before")[k] + marks.column("after")[k]), marks.column("jump")[k] > 0
        for axes, q in zip(panels, names):
            ends = [marks.column(f"{q}_rms_{side}")[k] for side in ("before", "after")]
            if jump:
                axes.annotate("", xy=(at, ends[1]), xytext=(at, ends[0]), zorder=2,
                              arrowprops={"arrowstyle": "-|>", "color": WAYS[way][1], "linewidth": 1.0, "shrinkA": 0, "shrinkB": 0})
            else:
                axes.axvline(at, color=GREY, linewidth=0.9, linestyle=(0, (1, 1.5)), zorder=1)
        if jump:
            panels[0].annotate(f"{at:.4f}", xy=(at, 1.0), xycoords=("data", "axes fraction"), xytext=(0, 2), textcoords="offset points",
                               ha="center", va="bottom", fontsize=8, color=WAYS[way][1])
