"""The settled motions of a superharmonic study and the averaged motions they are compared with. No drawing."""
from dataclasses import dataclass

import numpy as np

from figures_common import knots_of
from result_file import Group

SAME = 1e-3      # runs of one frequency settled on one motion when their harmonics agree to this share of the largest
IN_PLANE = 1e-3  # whirling part below this share of the in-plane part: the motion is called in plane
HARMONICS = range(6)


@dataclass
class Motion:
    """A settled motion. Runs of one frequency that end on it, or on its mirror image, count once."""
    run: int          # number of the first such run: series and spectra carry it
    omega: float
    A: float
    B: float
    kind: str         # periodic, quasi-periodic, chaotic, unsettled
    multiple: int     # period in excitation periods
    in_plane: bool
    runs: int = 1

    def words(self):
        """What it is: the word whirling is kept for the motion of period T that the averaged equations know."""
        shape = "in plane" if self.in_plane else "whirling" if self.multiple == 1 else "coupled"
        if self.kind != "periodic":
            return f"{shape}, {self.kind}"
        return shape if self.multiple == 1 else f"{shape}, period {self.multiple}T"


@dataclass
class Averaged:
    """An averaged steady state, with its orbit where the file holds one."""
    omega: float
    A: float
    B: float
    stable: bool
    orbit: Group = None

    @property
    def in_plane(self):
        return self.A <= IN_PLANE * self.B


@dataclass
class Comparison:
    """A settled motion and the stable averaged state nearest to it in (A, B)."""
    motion: Motion
    averaged: Averaged
    counterpart: bool  # the averaged equations have a stable motion of this kind here, and no unstable one is nearer

    @property
    def error(self):
        return {"A": self.averaged.A - self.motion.A, "B": self.averaged.B - self.motion.B}


def order_of(result):
    return int(result.group("study").attributes.get("response.order", 2))


# --- integrated ------------------------------------------------------------------------------------------------------------

def distinct_motions(result):
    """The distinct settled motions of the verification runs, in order of frequency."""
    found, harmonics = [], []
    for motion, h in motions_and_harmonics(result, "runs"):
        twin = next((m for m, known in zip(found, harmonics) if same(m, known, motion, h)), None)
        if twin:
            twin.runs += 1
        else:
            found.append(motion)
            harmonics.append(h)
    return sorted(found, key=lambda m: (m.omega, m.in_plane, -m.B))


def sweep_motions(result, direction):
    return [motion for motion, _ in motions_and_harmonics(result, f"sweep_{direction}")]


def motions_and_harmonics(result, table_name):
    table, order = result.group(f"verification/{table_name}"), order_of(result)
    for row in range(table.rows()):
        h = np.array([[table.column(f"q{i}_h{k}")[row] for k in HARMONICS] for i in (1, 2)])
        if np.all(np.isfinite(h)) and table.column("motion")[row] != "failed":
            run = row + 1 if table_name == "runs" else 0
            yield motion_of(result, table, row, run, h, order), h


def motion_of(result, table, row, run, h, order):
    spectrum = result.group(f"verification/spectra/run{run}").columns
    amplitudes = [spectrum["q1"], spectrum["q2"]] if spectrum else h
    A, B = (amplitude_at(spectrum, h, i, order) for i in (0, 1))
    in_plane = bool(np.max(amplitudes[0]) <= IN_PLANE * np.max(amplitudes[1]))
    multiple = 1 if spectrum and repeats_every_period(spectrum) else int(table.column("multiple")[row])
    return Motion(run, float(table.column("omega")[row]), A, B, str(table.column("motion")[row]), multiple, in_plane)


def repeats_every_period(spectrum):
    """No share at fractions of the excitation frequency: of period T, though its settling was seen after several periods only."""
    largest = max(np.max(spectrum["q1"]), np.max(spectrum["q2"]))
    fractional = ~np.isclose(spectrum["harmonic"], np.round(spectrum["harmonic"]))
    return not np.any(fractional) or max(np.max(spectrum[q][fractional]) for q in ("q1", "q2")) <= 1e-6 * largest


def amplitude_at(spectrum, h, coordinate, order):
    """From the table of runs, or from the spectrum when the order lies beyond the table."""
    if order in HARMONICS:
        return float(h[coordinate][order])
    at = np.flatnonzero(np.isclose(spectrum["harmonic"], order)) if spectrum else []
    return float(spectrum[f"q{coordinate + 1}"][at[0]]) if len(at) else np.nan


def same(motion, known, other, h):
    if (motion.omega, motion.kind, motion.multiple) != (other.omega, other.kind, other.multiple):
        return False
    return motion.kind == "chaotic" or bool(np.max(np.abs(known - h)) <= SAME * np.max(known))


# --- averaged --------------------------------------------------------------------------------------------------------------

def averaged_orbits(result, omega):
    """Averaged states at a verification frequency, with their orbits."""
    groups = result.group("verification/averaged").groups.values()
    return [state_of(g, order_of(result)) for g in groups if np.isclose(g.attributes["omega"], omega, rtol=1e-9)]


def state_of(orbit, order):
    """Amplitudes of the superharmonic from one sampled period; the last sample repeats the first."""
    A, B = (2 * np.abs(np.fft.rfft(orbit.column(q)[:-1])[order]) / (len(orbit.column(q)) - 1) for q in ("q1", "q2"))
    return Averaged(orbit.attributes["omega"], A, B, bool(orbit.attributes["stable"]), orbit)


class AveragedBranches:
    """All averaged states at any frequency, interpolated along the branches."""

    def __init__(self, result, order):
        columns = ["omega", f"q1_h{order}", f"q2_h{order}"]
        names = [name for name, branch in result.group("branches").groups.items() if branch.rows() > 1]
        self.curves = [refined(knots_of(result, name, columns), columns) for name in names]

    def at(self, omega):
        states = []
        for (w, A, B), calm in self.curves:
            rounding = 1e-9 * omega
            low, high = np.minimum(w[:-1], w[1:]) - rounding, np.maximum(w[:-1], w[1:]) + rounding
            for i in np.flatnonzero((low <= omega) & (omega <= high)):
                share = (omega - w[i]) / (w[i + 1] - w[i]) if abs(w[i + 1] - w[i]) > rounding else 0.0
                between = [float(a[i] + share * (a[i + 1] - a[i])) for a in (A, B)]
                states.append(Averaged(omega, *between, bool(calm[i])))
        return states


def refined(knots, columns, parts=16):
    """Cubics through the knots, in arclength, sampled: the branch bends between computed points as it does beside them."""
    distinct = np.append(True, np.diff(knots.arclength) > 1e-9)
    s, calm = knots.arclength[distinct], knots.calm[distinct[1:]]
    h = np.diff(s)[:, None]
    t = np.linspace(0, 1, parts, endpoint=False)[None, :]
    curves = []
    for values in (knots.columns[c][distinct] for c in columns):
        slope = np.gradient(values, s, edge_order=2 if len(s) > 2 else 1)
        ends = values[:-1, None], values[1:, None], slope[:-1, None] * h, slope[1:, None] * h
        weights = 1 - 3 * t**2 + 2 * t**3, 3 * t**2 - 2 * t**3, t - 2 * t**2 + t**3, t**3 - t**2
        curves.append(np.append(sum(e * w for e, w in zip(ends, weights)).ravel(), values[-1]))
    return curves, np.repeat(calm, parts)


def nearest(states, motion):
    return min(states, key=lambda s: np.hypot(s.A - motion.A, s.B - motion.B), default=None)


def compare(states, motion):
    """Against the nearest stable averaged state; None where there is none."""
    stable = nearest([s for s in states if s.stable], motion)
    if stable is None or not np.isfinite(motion.A + motion.B):
        return None
    alike = stable.in_plane == motion.in_plane and motion.kind == "periodic" and motion.multiple == 1
    return Comparison(motion, stable, alike and nearest(states, motion).stable)
