"""The settled motions of a superharmonic study and the averaged motions they are compared with. No drawing."""
from dataclasses import dataclass

import numpy as np

from figures_common import knots_of

SAME = 1e-3      # two runs of one frequency settled on one motion when their harmonics agree to this share of the largest
IN_PLANE = 1e-3  # q1 below this share of q2: the motion is called in plane
HARMONICS = range(6)


@dataclass
class Motion:
    """A settled motion; runs of one frequency that end on it (or on its mirror image) count once."""
    run: int           # number of the first such run: series and spectra carry it
    omega: float
    A: float
    B: float
    kind: str          # periodic, quasi-periodic, chaotic, unsettled
    multiple: int      # period in excitation periods
    in_plane: bool
    runs: int = 1

    def words(self):
        shape = "in plane" if self.in_plane else "whirling" if self.multiple == 1 else "coupled"
        if self.kind != "periodic":
            return f"{shape}, {self.kind}"
        return shape if self.multiple == 1 else f"{shape}, period {self.multiple}T"


@dataclass
class Averaged:
    """An averaged steady state."""
    omega: float
    A: float
    B: float
    stable: bool
    group: str = ""

    @property
    def in_plane(self):
        return self.A <= IN_PLANE * self.B


def order_of(result):
    return int(result.group("study").attributes.get("response.order", 2))


def settled_motions(result, table, order, distinct):
    """Motions of a table of runs or of a sweep; failed rows left out."""
    motions, seen = [], []
    harmonics = np.array([[table.column(f"q{i}_h{k}") for k in HARMONICS] for i in (1, 2)]) if table.rows() else np.empty((2, 6, 0))
    for row in range(table.rows()):
        h = harmonics[:, :, row]
        motion = motion_of(table, row, h, order)
        if motion is None:
            continue
        twin = next((m for m, known in zip(motions, seen) if same(m, known, motion, h)), None) if distinct else None
        if twin:
            twin.runs += 1
            continue
        motions.append(motion)
        seen.append(h)
    return motions


def motion_of(table, row, h, order):
    kind = str(table.column("motion")[row])
    if kind == "failed" or not np.all(np.isfinite(h)):
        return None
    A, B = (table.column(f"q{i}_h{order}")[row] if order in HARMONICS else np.nan for i in (1, 2))
    in_plane = bool(np.max(h[0]) <= IN_PLANE * np.max(h[1]))
    if int(table.column("multiple")[row]) > 1 and "largest_q1" not in table.columns:
        in_plane = in_plane and True  # whole harmonics only are in the table; the series decides where there is one
    return Motion(row + 1, float(table.column("omega")[row]), float(A), float(B), kind, int(table.column("multiple")[row]), in_plane)


def same(motion, known, other, h):
    if motion.omega != other.omega or motion.kind != other.kind or motion.multiple != other.multiple:
        return False
    return motion.kind == "chaotic" or bool(np.max(np.abs(known - h)) <= SAME * max(np.max(known), 1e-9))
