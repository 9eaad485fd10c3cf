"""Figures of a superharmonic study: response curves, orbits, spectra, time series, error of the averaged equations."""
import numpy as np
from matplotlib.markers import CARETDOWN, CARETUP
from matplotlib.ticker import MultipleLocator

from figures_branches import bifurcation_panel, drawable, note, write_tags
from figures_common import (BLUE, DASHES, GREEN, GREY, INK, NB, PURPLE, SKY, SYMBOLS, VERMILLION, Page, damping_words, label,
                            letter, line_key, marker_key, number, parameter_of, special_keys, special_points, stability_keys,
                            study_words)
from figures_modulation import modulation
from superharmonic_motions import (AveragedBranches, averaged_orbits, compare, distinct_motions, nearest, order_of, state_of,
                                   sweep_motions)

IN_PLANE, WHIRLING = BLUE, VERMILLION
# The tip of a triangle is the value: motions met on the way up and on the way down stay apart.
SWEEPS = {"up": (CARETUP, GREEN), "down": (CARETDOWN, PURPLE)}
STABLE_ORBIT = {"color": SKY, "linewidth": 3.4}
UNSTABLE_ORBIT = {"color": VERMILLION, "linewidth": 3.2, "linestyle": (0, (2.2, 1.4))}
PLUS = {"markersize": 9, "markeredgewidth": 1.5, "color": INK}


def figures(result):
    all_of_them = (response, whirling_orbits, verification_orbits, spectrum, time_series, error, modulation)
    return [drawn for drawn in (figure(result) for figure in all_of_them) if drawn]


def study(result, **which):
    return study_words(result, f"Superharmonic study of order {order_of(result)}", **which)


def colours(result, names, column):
    """In-plane and whirling branches in two colours."""
    branches = result.group("branches")
    return {n: WHIRLING if np.max(branches.group(n).column(column)) > 1e-9 else IN_PLANE for n in names}


# --- response --------------------------------------------------------------------------------------------------------------

def response(result):
    names, n = drawable(result), order_of(result)
    if not names:
        return None
    columns = [f"q1_h{n}", f"q2_h{n}"]
    x = parameter_of(result, result.group("branches").group(names[0]))
    colour = colours(result, names, columns[0])
    points = special_points(result, [x, *columns])
    legend = branch_keys(result, colour) + special_keys(points) + (integrated_keys(result) if x == "omega" else [])
    title = f"Response at {n}ω: branches of the averaged equations" + with_integration(result, x)
    in_plane_only = WHIRLING not in colour.values()
    page = Page(7.0, 5.2 if in_plane_only else 7.0, title, [study(result)], legend)
    panels = page.subplots(2, 1, sharex=True, gridspec_kw={"height_ratios": [1, 2.2 if in_plane_only else 1]})[:, 0]
    for axes, column, symbol, where in zip(panels, columns, "AB", ("out of plane", "in plane")):
        bifurcation_panel(axes, result, names, x, column, points, colour.get)
        if x == "omega":
            draw_integrated(axes, result, symbol)
        axes.set_ylabel(f"${symbol}$ [m], {where}")
        fit_amplitudes(axes)
    panels[1].set_xlabel(label(SYMBOLS.get(x, x), result.group("branches").group(names[0]).units[x]))
    if x == "omega":
        ratio_axis(panels[0], result)
    if in_plane_only:
        note(panels[0], "no whirling branch: $A$ = 0 on every averaged branch", (0.98, 0.86))
    page.finish()
    for axes, column in zip(panels, columns):
        write_tags(axes, result, names, x, column, points, colour.get)
    return "response", page.figure


def with_integration(result, x):
    return " and time integration" if x == "omega" and result.group("verification/runs") else ""


def branch_keys(result, colour):
    keys = []
    for words, c in (("in plane, ", IN_PLANE), ("whirling, ", WHIRLING)):
        branches = [result.group("branches").group(n) for n in colour if colour[n] == c]
        keys += stability_keys(branches, c, words) if branches else []
    return keys


def integrated_keys(result):
    keys = [marker_key("integrated", "+", **PLUS)] if result.group("verification/runs") else []
    for way, (marker, colour) in SWEEPS.items():
        motions = sweep_motions(result, way)
        if motions:
            keys.append(marker_key(f"sweep {way}", marker, markersize=5, color=colour))
        if any(not follows_excitation(m) for m in motions):
            keys.append(marker_key(f"sweep {way}, period ≠ T", marker, markersize=5, color=colour, markerfacecolor="white"))
    return keys


def follows_excitation(motion):
    return motion.kind == "periodic" and motion.multiple == 1


def draw_integrated(axes, result, symbol):
    for way, (marker, colour) in SWEEPS.items():
        motions = sweep_motions(result, way)
        for full in (True, False):
            chosen = [m for m in motions if follows_excitation(m) == full]
            draw_motions(axes, chosen, symbol, marker=marker, markersize=5, color=colour, zorder=4, markeredgewidth=0.8,
                         markerfacecolor=colour if full else "white")
    draw_motions(axes, distinct_motions(result), symbol, marker="+", zorder=7, **PLUS)


def draw_motions(axes, motions, symbol, **style):
    if motions:  # an empty unclipped line would stretch the layout
        axes.plot([m.omega for m in motions], [getattr(m, symbol) for m in motions], linestyle="none", clip_on=False, **style)


def fit_amplitudes(axes):
    """From zero up; a panel of zeros keeps a scale of its own."""
    top = max((np.nanmax(line.get_ydata()) for line in axes.lines if len(line.get_ydata())), default=1.0)
    top = top if top > 1e-9 else 1.0
    axes.set_ylim(-0.05 * top, 1.12 * top)


def ratio_axis(axes, result):
    w1 = result.group("cable").columns.get("omega1")
    if w1 is None:
        return
    top = axes.secondary_xaxis("top", functions=(lambda w: w / w1, lambda r: r * w1))
    top.set_xlabel(SYMBOLS["omega_ratio"] + rf",  $\omega_1$ = {w1:.4g} rad/s")


# --- orbits ----------------------------------------------------------------------------------------------------------------

def grid(count, most=3):
    """Rows and columns of a sheet of small panels."""
    columns = 2 if count in (2, 4) else min(count, most)
    return -(-count // columns), columns


def whirling_orbits(result):
    """Averaged against integrated, one panel per pair of dampings."""
    pairs = [g for g in ordered(result.group("orbits").groups) if g.group("integrated") or g.group("averaged")]
    if not pairs:
        return None
    cells = [(f"{letter(i)} {damping_words(p.attributes['damping_out_of_plane'], p.attributes['damping_in_plane'])}{unusual(p)}",
              [p.group("averaged")] if p.group("averaged") else [], p.group("integrated")) for i, p in enumerate(pairs)]
    omega = pairs[0].attributes["omega"]
    title = f"Orbits at ω = {omega:g} rad/s: averaged against integrated"
    return "orbits", orbit_sheet(cells, title, f"{study(result, varied='omega', damping=False)}; damping in the panels",
                                 5.4 if len(cells) > 1 else 4.4)


def unusual(pair):
    motion = pair.group("integrated").attributes
    if not motion:
        return ", not integrated"
    return "" if motion.get("motion") == "periodic" and motion.get("multiple") == 1 else f", {motion.get('motion')}"


def ordered(groups):
    """run2 before run10."""
    return [groups[k] for k in sorted(groups, key=lambda k: (len(k), k))]


def verification_orbits(result):
    """The orbit of every distinct settled motion, on the averaged orbit nearest to it."""
    cells = []
    for i, m in enumerate(distinct_motions(result)):
        series = result.group(f"verification/series/run{m.run}")
        if series:
            closest = nearest(averaged_orbits(result, m.omega), m)
            cells.append((motion_title(i, m), [closest.orbit] if closest else [], series))
    title = "Orbits of the settled motions: averaged against integrated"
    return ("orbits-verification", orbit_sheet(cells, title, study(result), 7.0)) if cells else None


def motion_title(i, motion):
    return f"{letter(i)} " + rf"$\omega$ = {motion.omega:g} rad/s, {motion.words()}"


def orbit_sheet(cells, title, sentence, width):
    rows, columns = grid(len(cells))
    left, right, low, high = orbit_reach(cells)
    cell = (width - 0.5) / columns - 0.15
    page = Page(width, rows * (cell * (high - low) / (right - left) + 0.35) + 0.3, title, [sentence], orbit_keys(cells))
    panels = page.subplots(rows, columns, sharex=True, sharey=True)
    for axes, (words, averaged, integrated) in zip(panels.ravel(), cells):
        draw_orbits(axes, averaged, integrated)
        axes.set_title(words, loc="left")
    finish_sheet(panels, len(cells), r"$q_1$ [m], out of plane", r"$q_2$ [m], in plane")
    panels[0, 0].axis((left, right, low, high))
    page.finish()
    equal_scales(panels[0, 0], left, right, low, high)
    return page.figure


def orbit_keys(cells):
    stabilities = {bool(o.attributes["stable"]) for _, averaged, _ in cells for o in averaged}
    keys = [line_key("averaged, stable", **STABLE_ORBIT)] if True in stabilities else []
    keys += [line_key("averaged, unstable", **UNSTABLE_ORBIT)] if False in stabilities else []
    return keys + [line_key("integrated", color=INK, linewidth=1.2),
                   marker_key("start of a period" + (" (open: averaged)" if stabilities else ""), "o", color=INK, markersize=4.5)]


def equal_scales(axes, left, right, low, high):
    """A metre is as long across as up: the direction with room to spare is widened. The panels share it."""
    box = axes.get_window_extent()
    across, up = box.width / (right - left), box.height / (high - low)
    more_x, more_y = max(across / up - 1, 0), max(up / across - 1, 0)
    axes.set_xlim(left - more_x * (right - left) / 2, right + more_x * (right - left) / 2)
    axes.set_ylim(low - more_y * (high - low) / 2, high + more_y * (high - low) / 2)
    step = next(s for s in (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 1e9) if (right - left) / s <= 6)
    axes.xaxis.set_major_locator(MultipleLocator(step))
    axes.yaxis.set_major_locator(MultipleLocator(step))


def orbit_reach(cells, plane=("q1", "q2")):
    """One scale for all panels. The first coordinate of a plane is the one whose change of sign maps motions to motions."""
    orbits = [o for _, averaged, integrated in cells for o in [*averaged, integrated] if o]
    x, y = plane
    low, high = min(np.min(o.column(y)) for o in orbits), max(np.max(o.column(y)) for o in orbits)
    half = 1.08 * max(max(np.max(np.abs(o.column(x))) for o in orbits), 0.12 * (high - low))
    rim = 0.06 * (high - low)
    return -half, half, low - rim, high + rim


def draw_orbits(axes, averaged, integrated, plane=("q1", "q2")):
    x, y = plane
    axes.axhline(0, color="#e4e4e4", linewidth=0.7, zorder=0)
    axes.axvline(0, color="#e4e4e4", linewidth=0.7, zorder=0)
    for orbit in averaged:
        sign = mirror_like(orbit, integrated, x)
        q1, q2 = path(sign * orbit.column(x), orbit.column(y))
        look = STABLE_ORBIT if orbit.attributes["stable"] else UNSTABLE_ORBIT
        axes.plot(q1, q2, zorder=2, **look)
        axes.plot(sign * orbit.column(x)[0], orbit.column(y)[0], "o", markersize=6.5, markerfacecolor="white",
                  markeredgewidth=1.3, markeredgecolor=look["color"], zorder=5)
    if not averaged:
        note(axes, "no averaged whirling motion", (0.97, 0.98))
    if integrated:
        q1, q2 = (smooth(integrated, q)[1] for q in plane)
        axes.plot(q1, q2, color=INK, linewidth=1.2, zorder=4)
        axes.plot(q1[0], q2[0], "o", color=INK, markersize=4.2, zorder=6)


def path(q1, q2):
    """The orbit; a motion in plane as one stroke, since dashes drawn to and fro would fill each other's gaps."""
    if np.max(np.abs(q1)) <= 1e-6 * np.max(np.abs(q2)):
        return np.zeros(2), np.array([np.min(q2), np.max(q2)])
    return q1, q2


def smooth(series, q, times=4):
    """A periodic record, closed and with samples between by its own Fourier series; any other record as it is."""
    t, values = series.column("t"), series.column(q)
    if series.attributes.get("motion") != "periodic":
        return t, values
    n = len(values)
    fine = np.fft.irfft(np.fft.rfft(values), times * n) * times
    return np.append(t[0] + (t[1] - t[0]) / times * np.arange(times * n), t[0] + (t[1] - t[0]) * n), np.append(fine, fine[0])


def mirror_like(orbit, integrated, x):
    """x -> -x maps motions to motions: the averaged orbit is shown on the side the integrated one settled on."""
    if not integrated:
        return 1
    t = orbit.column("t")[:-1]
    at = np.interp(t, integrated.column("t"), integrated.column(x))
    q1 = orbit.column(x)[:-1]
    return 1 if np.sum((q1 - at) ** 2) <= np.sum((q1 + at) ** 2) else -1


def finish_sheet(panels, used, x_label, y_label):
    """Empty cells off; outer labels only, under the lowest panel of each column."""
    rows, columns = panels.shape
    for k, axes in enumerate(panels.ravel()):
        axes.set_visible(k < used)
        if k + columns >= used:
            axes.set_xlabel(x_label)
            axes.tick_params(labelbottom=True)
        if k % columns == 0:
            axes.set_ylabel(y_label)


# --- spectrum --------------------------------------------------------------------------------------------------------------

FLOOR = 1e-3  # m


def spectrum(result):
    motions = [m for m in distinct_motions(result) if result.group(f"verification/spectra/run{m.run}")]
    if not motions:
        return None
    n = order_of(result)
    keys = [marker_key("$q_1$, out of plane", "o", color=WHIRLING, markersize=5),
            marker_key("$q_2$, in plane", "s", color=IN_PLANE, markersize=5),
            marker_key(rf"nearest averaged motion: $B_0$ at $\omega$, $A$ and $B$ at {n}$\omega$", "_", color=INK, markersize=11,
                       markeredgewidth=1.6)]
    rows, columns = grid(len(motions), 3)
    page = Page(7.0, 2.35 * rows + 0.2, "Harmonics of the settled motions", [study(result)], keys)
    panels = page.subplots(rows, columns, sharex=True, sharey=True)
    last = last_harmonic(result, motions)
    for i, (axes, m) in enumerate(zip(panels.ravel(), motions)):
        draw_spectrum(axes, result.group(f"verification/spectra/run{m.run}"))
        state = nearest(averaged_orbits(result, m.omega), m)
        draw_averaged_harmonics(axes, state, n)
        axes.set_title(motion_title(i, m), loc="left", fontsize=9)
        axes.xaxis.set_major_locator(MultipleLocator(1 if columns < 3 or last < 5 else 2))
        axes.xaxis.set_minor_locator(MultipleLocator(1))
    panels[0, 0].set_xlim(-0.5, last + 0.5)
    panels[0, 0].set_ylim(FLOOR, 6 * highest(result, motions))
    finish_sheet(panels, len(motions), r"frequency / $\omega$", "amplitude [m]")
    return "spectrum", page.finish()


def last_harmonic(result, motions):
    """The highest frequency with an amplitude above the floor."""
    tables = [result.group(f"verification/spectra/run{m.run}") for m in motions]
    return max(np.max(t.column("harmonic")[np.maximum(t.column("q1"), t.column("q2")) > FLOOR], initial=3) for t in tables)


def highest(result, motions):
    return max(np.max(result.group(f"verification/spectra/run{m.run}").column(q)) for m in motions for q in ("q1", "q2"))


def draw_spectrum(axes, table):
    """Stems on a logarithmic scale; what lies below the floor is not drawn but said."""
    h = table.column("harmonic")
    aside = 0.12 * min(1.0, 2.5 * (h[1] - h[0]))
    for q, marker, colour, shift in (("q1", "o", WHIRLING, -aside), ("q2", "s", IN_PLANE, aside)):
        seen = table.column(q) > FLOOR
        axes.vlines(h[seen] + shift, FLOOR, table.column(q)[seen], color=colour, linewidth=1.2)
        axes.plot(h[seen] + shift, table.column(q)[seen], linestyle="none", marker=marker, markersize=3.6, color=colour)
        if not np.any(seen):
            note(axes, f"$q_{q[1]}$ < {FLOOR:g} m throughout", (0.98, 0.975))
    axes.set_yscale("log")
    axes.grid(True, axis="y", color="#ececec", linewidth=0.6)
    axes.set_axisbelow(True)


def draw_averaged_harmonics(axes, state, order):
    if state is None:
        return
    first = state_of(state.orbit, 1)
    marks = [(1, first.B), (order, state.A), (order, state.B)]
    marks = [(k, a, -0.12 if i == 1 else 0.12) for i, (k, a) in enumerate(marks) if a > FLOOR]
    axes.plot([k + shift for k, _, shift in marks], [a for _, a, _ in marks], linestyle="none", marker="_", color=INK,
              markersize=9, markeredgewidth=1.5, zorder=5)


# --- time series -----------------------------------------------------------------------------------------------------------

PERIODS = 4


def time_series(result):
    motions = [m for m in distinct_motions(result) if result.group(f"verification/series/run{m.run}")]
    if not motions:
        return None
    keys = [line_key("$q_1(t)$, out of plane", color=WHIRLING, linewidth=1.5, linestyle=DASHES),
            line_key("$q_2(t)$, in plane", color=IN_PLANE, linewidth=1.5),
            line_key("excitation periods", color="#bdbdbd", linewidth=0.8)]
    page = Page(7.0, 1.45 * len(motions) + 0.35, "Settled motions by time integration", [study(result)], keys)
    panels = page.subplots(len(motions), 1, sharex=True, sharey=True)[:, 0]
    longest = max(shown_periods(m) * period(m) for m in motions)
    for i, (axes, m) in enumerate(zip(panels, motions)):
        draw_series(axes, result.group(f"verification/series/run{m.run}"), m)
        axes.set_title(motion_title(i, m), loc="left")
        axes.set_ylabel("$q_1$, $q_2$ [m]")
        axes.set_xlim(0, longest)
    panels[-1].set_xlabel("$t$ [s]")
    return "time", page.finish()


def period(motion):
    return 2 * np.pi / motion.omega


def shown_periods(motion):
    return max(PERIODS, 2 * motion.multiple) if motion.kind == "periodic" else 2 * PERIODS


def draw_series(axes, series, motion):
    end = shown_periods(motion) * period(motion)
    axes.axhline(0, color="#e4e4e4", linewidth=0.7, zorder=0)
    for k in range(1, shown_periods(motion) + 1):
        axes.axvline(k * period(motion), color="#bdbdbd", linewidth=0.8, zorder=0)
    for q, colour, style in (("q2", IN_PLANE, "-"), ("q1", WHIRLING, DASHES)):
        t, values = repeated(series, q, motion, end)
        axes.plot(t, values, color=colour, linestyle=style, linewidth=1.5)


def repeated(series, q, motion, end):
    """A periodic record is repeated to fill the panel; any other is shown as far as it goes."""
    t, values = smooth(series, q)
    if motion.kind == "periodic":
        copies = int(np.ceil(end / t[-1] - 1e-9))
        t = np.concatenate([t[:-1] + k * t[-1] for k in range(copies)] + [[copies * t[-1]]])
        values = np.concatenate([values[:-1]] * copies + [values[-1:]])
    return t[t <= end * (1 + 1e-9)], values[t <= end * (1 + 1e-9)]


# --- error -----------------------------------------------------------------------------------------------------------------

def error(result):
    """Averaged minus integrated at every settled motion of the runs and sweeps."""
    if parameter_is_not_omega(result):
        return None
    sources = comparisons(result)
    every = [c for _, _, _, found in sources for c in found]
    if not every:
        return None
    keys = [marker_key(words, marker, **style) for words, marker, style, found in sources if found]
    if any(not c.counterpart for c in every):
        keys.append(marker_key("no stable averaged counterpart", "o", markersize=9,
                               markerfacecolor="none", markeredgecolor=GREY, markeredgewidth=0.9))
    sentences = [*error_sentences(every), study(result)]
    page = Page(7.0, 5.4, "Averaged minus integrated: each motion against the nearest stable averaged one", sentences, keys)
    panels = page.subplots(2, 1, sharex=True)[:, 0]
    for axes, symbol in zip(panels, "AB"):
        draw_error(axes, sources, symbol)
        axes.set_ylabel(f"error of ${symbol}$ [m]")
    if max(abs(c.error["A"]) for c in every) < 1e-6:
        panels[0].set_ylim(panels[1].get_ylim())
        note(panels[0], "no error: all motions are in plane")
    panels[1].set_xlabel(label(SYMBOLS["omega"], "rad/s"))
    ratio_axis(panels[0], result)
    return "error", page.finish()


def parameter_is_not_omega(result):
    return str(result.group("study").attributes.get("continuation.parameter", "omega")) != "omega" or not drawable(result)


def comparisons(result):
    """(words, marker, style, comparisons) of the runs and of each sweep."""
    branches = AveragedBranches(result, order_of(result))

    def compared(motions):
        found = [compare(branches.at(m.omega), m) for m in motions]
        return [c for c in found if c]

    sources = [("integrated", "+", PLUS, compared(distinct_motions(result)))]
    for way, (marker, colour) in SWEEPS.items():
        sources.append((f"sweep {way}", marker, {"markersize": 5.5, "color": colour}, compared(sweep_motions(result, way))))
    return sources


def error_sentences(every):
    """The largest errors: of all motions, and of those that the averaged equations have at all."""
    matched = [c for c in every if c.counterpart]
    sentences = [f"Largest error: {largest(every)}."]
    if matched and largest(matched) != largest(every):
        sentences.append(f"Largest where a stable averaged counterpart exists: {largest(matched)}.")
    if len(matched) < len(every):
        sentences.append("Ringed: the averaged motion compared with is of another kind or period, or a nearer one is unstable.")
    return sentences


def largest(compared):
    return " and ".join(filter(None, (largest_of(compared, symbol) for symbol in "AB"))) or "none"


def largest_of(compared, symbol):
    worst = max(compared, key=lambda c: abs(c.error[symbol]))
    e, integrated = worst.error[symbol], getattr(worst.motion, symbol)
    if abs(e) < 1e-6:
        return ""
    share = f"{number(100 * e / integrated)} %" if integrated > 1e-6 else f"integrated ${symbol}$ is zero"
    return " ".join(p.replace(" ", NB) for p in (f"{number(e)} m in ${symbol}$", f"({share})",
                                                 rf"at $\omega$ = {worst.motion.omega:.4g} rad/s"))


def draw_error(axes, sources, symbol):
    axes.axhline(0, color=INK, linewidth=0.8)
    for _, marker, style, found in sources:
        axes.plot([c.motion.omega for c in found], [c.error[symbol] for c in found], linestyle="none", marker=marker, zorder=4,
                  **style)
    lonely = [c for _, _, _, found in sources for c in found if not c.counterpart]
    axes.plot([c.motion.omega for c in lonely], [c.error[symbol] for c in lonely], linestyle="none", marker="o", markersize=9,
              markerfacecolor="none", markeredgecolor=GREY, markeredgewidth=0.9, zorder=3)
    axes.grid(True, color="#ececec", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.margins(x=0.03, y=0.1)
