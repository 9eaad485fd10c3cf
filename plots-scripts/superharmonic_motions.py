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
    return Motion(run, float(table.column("omega")[row]), A, B, str(table.column("motion")[row]), int(table.column("multiple")[row]),
                  in_plane)


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
        self.columns = ["omega", f"q1_h{order}", f"q2_h{order}"]
        self.branches = [knots_of(result, name, self.columns) for name, b in result.group("branches").groups.items() if b.rows() > 1]

    def at(self, omega):
        states = []
        for knots in self.branches:
            w, A, B = (knots.columns[c] for c in self.columns)
            for i in np.flatnonzero((np.minimum(w[:-1], w[1:]) <= omega) & (omega <= np.maximum(w[:-1], w[1:]))):
                share = (omega - w[i]) / (w[i + 1] - w[i]) if w[i + 1] != w[i] else 0.0
                states.append(Averaged(omega, A[i] + share * (A[i + 1] - A[i]), B[i] + share * (B[i + 1] - B[i]), bool(knots.calm[i])))
        return states


def nearest(states, motion):
    return min(states, key=lambda s: np.hypot(s.A - motion.A, s.B - motion.B), default=None)


def compare(states, motion):
    """Against the nearest stable averaged state; None where there is none."""
    stable = nearest([s for s in states if s.stable], motion)
    if stable is None or not np.isfinite(motion.A + motion.B):
        return None
    return Comparison(motion, stable, nearest(states, motion).stable and stable.in_plane == motion.in_plane and motion.multiple == 1)
