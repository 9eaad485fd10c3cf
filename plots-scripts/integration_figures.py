"""What the figures of `integrate` and `basins` share: states by name, words of a motion, orbits, spectra."""
import numpy as np
from matplotlib.ticker import MaxNLocator

from figures_common import BLUE, DASHES, GREEN, INK, ORANGE, PURPLE, SKY, VERMILLION, SYMBOLS, label, line_key

# First coordinate of a cable: out of plane; second: in plane. Solid and dashed keep them apart without colour.
COORDINATES = ((VERMILLION, DASHES, "o"), (BLUE, "-", "s"), (GREEN, (0, (1.0, 1.2)), "^"), (PURPLE, (0, (5, 1, 1, 1)), "D"),
               (ORANGE, (0, (3, 1)), "v"), (SKY, (0, (1, 2)), "p"))


def style(i):
    return COORDINATES[i % len(COORDINATES)]


def coordinates(table):
    """Names of the coordinates: the states that have a velocity beside them."""
    return [name for name in table.columns if f"{name}'" in table.columns]


def symbol(state):
    """q1' as text with a subscript and a dot."""
    name, dot = state.rstrip("'"), state.endswith("'")
    stem = name.rstrip("0123456789")
    inner = f"{stem}_{{{name[len(stem):]}}}" if len(stem) < len(name) else stem
    return rf"$\dot{{{stem}}}_{{{name[len(stem):]}}}$" if dot else f"${inner}$"


def axis_label(table, state):
    return label(symbol(state), table.units.get(state, ""))


def motion_words(kind, multiple):
    return f"{kind}, period {int(multiple) if multiple > 1 else ''}$T$" if kind == "periodic" else kind


def text_column(table, name, row):
    return str(table.column(name)[row])


def draw_orbit(axes, series, section, states, colour=INK):
    """The motion in the plane of two states, its stroboscopic points on it."""
    x, y = states
    a, b = series.column(x), series.column(y)
    few = len(section.column(x)) <= 24  # a period of so many excitation periods; a motion without period has hundreds
    if few:
        a, b = np.append(a, a[0]), np.append(b, b[0])
        axes.plot(a, b, color=colour, linewidth=1.0, zorder=2)
    else:
        axes.plot(a, b, color="#b8b8b8", linewidth=0.25, zorder=1)
    axes.plot(section.column(x), section.column(y), linestyle="none", marker="o" if few else ".", markersize=5 if few else 2.2,
              markerfacecolor="white" if few else VERMILLION, markeredgecolor=VERMILLION, markeredgewidth=1.3 if few else 0.0, zorder=4)


def coordinate_keys(names):
    return [line_key(symbol(q), color=style(i)[0], linestyle=style(i)[1], linewidth=1.3, marker=style(i)[2], markersize=3.5)
            for i, q in enumerate(names)]


def draw_lines(axes, spectrum, whole, names, floor, unit):
    """Spectral lines as stems over multiples of omega, the whole spectrum behind them where the motion has no period."""
    for i, name in enumerate(names):
        colour, _, marker = style(i)
        if whole.rows():
            axes.plot(whole.column("harmonic"), np.maximum(whole.column(name), floor), color=colour, linewidth=0.7, alpha=0.85,
                      zorder=2 - 0.1 * i)
        mine = (spectrum.column("coordinate") == i + 1) & (spectrum.column("amplitude") > floor)
        h, a = spectrum.column("harmonic")[mine] + 0.04 * (2 * i - len(names) + 1), spectrum.column("amplitude")[mine]
        if not whole.rows():
            axes.vlines(h, floor, a, color=colour, linewidth=1.0, zorder=3)
        axes.plot(h, a, linestyle="none", marker=marker, markersize=3.2, color=colour, zorder=4)
    axes.set_yscale("log")
    axes.set_xlim(-0.3, 6.3)
    axes.set_ylim(floor, None)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True, nbins=7))
    axes.grid(True, axis="y", color="#ececec", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.set_ylabel(label("amplitude", unit))


def parameter_label(name, unit):
    return label(SYMBOLS.get(name, name), unit)

