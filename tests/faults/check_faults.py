#!/usr/bin/python3
"""check_faults.py PROGRAM SHIM [--runs N] [--seed S]: kills runs of seven kinds at N random changes of their files each, and fills the disk.

After each fault the result's path must hold what stood there before, byte for byte, or a file with every branch (curve, table) that the run had finished, each
as in a run left alone, with its special points; `export` and `plot` must work on it, and the next run must end as if nothing had been.
"""
import argparse
import os
import random
import subprocess
import sys
import tempfile
import time

import h5py
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
STUDIES = os.path.join(HERE, "..", "..", "studies")
PLOT = os.path.join(HERE, "..", "..", "plots-scripts", "plot")

# Small studies of six kinds: the example and what makes it quick.
KINDS = {
    "superharmonic": ("oresund-superharmonic.toml", ["verification.enabled=false"]),
    "continuation": ("two-modes-pitchforks.toml", []),
    "two-parameter": ("oresund-threshold.toml", []),
    "periodic": ("../tests/cases/per_parametron249.toml", []),
    "integrate": ("oresund-integrate.toml", ["sweep.range=[]"]),
    "basins": ("oresund-basins.toml", ["basins.resolution=[5, 5]"]),
    "cycles": ("roessler-cycles.toml", ["continuation.range=[2.5, 3.0]", "cycles.period_doublings=1"]),
}
MODES = ("before", "half", "after", "full")


def run(program, kind, path, shim=None, mode=None, at=0):
    """The study's run, with the fault; exit status, (changes, commits, writes refused, renames) until then, standard error."""
    name, settings = KINDS[kind]
    log = path + ".log"
    command = [program, "run", os.path.join(STUDIES, name), "-q", "-o", path]
    for s in settings:
        command += ["--set", s]
    environment = dict(os.environ)
    if shim:
        environment.update(LD_PRELOAD=shim, WHIRL_FAULT=mode, WHIRL_FAULT_AT=str(at), WHIRL_FAULT_LOG=log)
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=600)
    counts = (0, 0, 0, 0)
    if os.path.exists(log):
        counts = tuple(int(n) for n in open(log).read().split())
        os.remove(log)
    return done.returncode, counts, done.stderr


def tables(path):
    """Every column of a result file: {path: values}."""
    found = {}
    with h5py.File(path, "r") as file:
        file.visititems(lambda name, node: found.update({name: node[()]}) if isinstance(node, h5py.Dataset) and node.ndim else None)
    return found


def same(a, b):
    return len(a) == len(b) and (a.dtype.kind == "O" and list(a) == list(b) or a.dtype.kind != "O" and np.array_equal(a, b, equal_nan=True))


class Reference:
    """A kind's run left alone: how many changes it makes, its tables, and which of them stand after each commit."""

    def __init__(self, program, shim, kind, folder):
        self.kind, self.path = kind, os.path.join(folder, f"{kind}.h5")
        status, (self.changes, self.commits, _, _), error = run(program, kind, self.path, shim, "count")
        assert status == 0, f"{kind}: {error}"
        self.tables = tables(self.path)
        self.after = {}

    def branches(self):
        return {name.rsplit("/", 1)[0] for name in self.tables if name.startswith(("branches/", "curves/"))}


def check_state(path, reference):
    """The tables of a file that a fault left, each finished one as in the run left alone."""
    found = tables(path)
    groups = {name.rsplit("/", 1)[0] for name in found if name.startswith(("branches/", "curves/"))}
    for group in groups & reference.branches():
        for name in (n for n in reference.tables if n.rsplit("/", 1)[0] == group):
            assert name in found and same(found[name], reference.tables[name]), f"{name} differs"
    if "special_points/branch" in reference.tables and groups:
        there = [b.decode() for b in found["special_points/branch"]]
        wanted = [b.decode() for b in reference.tables["special_points/branch"]]
        for group in groups:
            name = group.split("/")[-1]
            assert there.count(name) == wanted.count(name), f"special points of {name}"
    with h5py.File(path, "r") as file:
        outcome = file["study"].attrs["outcome"]
    return groups, outcome


class Checker:
    def __init__(self, program, shim, folder):
        self.program, self.shim, self.folder = program, shim, folder
        self.drawn = set()
        self.older = self.older_result()

    def older_result(self):
        """What a small run of another kind leaves: a result that a new run may replace."""
        path = os.path.join(self.folder, "older.h5")
        subprocess.run([self.program, "run", os.path.join(STUDIES, "oresund-modes.toml"), "-q", "-o", path], check=True, timeout=600)
        return open(path, "rb").read()

    def fault(self, reference, mode, at, old):
        path = os.path.join(self.folder, f"fault-{reference.kind}.h5")
        for leftover in (path, path + ".unfinished"):
            if os.path.exists(leftover):
                os.remove(leftover)
        if old is not None:
            open(path, "wb").write(old)
        status, (_, commits, refused, renames), error = run(self.program, reference.kind, path, self.shim, mode, at)
        if mode == "full" and refused == 0:  # what was left to do needed no room
            assert status == 0 and tables(path).keys() == reference.tables.keys(), f"status {status}: {error}"
        elif mode == "full":
            assert status == 1 and error.count("error: ") == 1, f"status {status}: {error}"
        else:
            assert status == -9, f"status {status}: {error}"
        if not os.path.exists(path):
            # the first commit of a table is followed by the renaming at once
            assert old is None and renames == 0 and commits <= 2, f"no result after {commits} commits, {renames} renames"
            return commits, None
        if old is not None and open(path, "rb").read() == old:
            return commits, None
        groups, outcome = check_state(path, reference)
        if mode == "full" and refused > 0:
            assert outcome in ("failed", "unfinished"), outcome
        self.usable(path, (reference.kind, outcome, *sorted(tables(path))))
        return commits, groups

    def usable(self, path, state):
        """`export` works on it, and `plot` once on each state: which tables there are, and the outcome."""
        out = os.path.join(self.folder, "csv")
        done = subprocess.run([self.program, "export", path, "-o", out], capture_output=True, text=True, timeout=600)
        assert done.returncode == 0, f"export: {done.stderr}"
        if state in self.drawn:
            return
        self.drawn.add(state)
        done = subprocess.run([PLOT, path, "-o", out, "--format", "png"], capture_output=True, text=True, timeout=600,
                              env=dict(os.environ, MPLBACKEND="Agg"))
        assert done.returncode == 0 or "holds nothing to draw" in done.stderr, f"plot: {done.stderr}"

    def kind(self, kind, runs, chance):
        begun = time.monotonic()
        reference = Reference(self.program, self.shim, kind, self.folder)
        finished = {}  # commits -> the branches that stand then: the same at every fault after as many
        states = kept = 0
        for i in range(runs):
            mode, at = MODES[i % len(MODES)], chance.randint(1, reference.changes)
            old = self.older if (i + i // len(MODES)) % 2 else None  # each mode with and without
            try:
                commits, groups = self.fault(reference, mode, at, old)
                states += groups is not None
                kept += len(groups or ())
                if groups is not None and mode != "full":
                    assert finished.setdefault(commits, groups) == groups, f"{commits} commits: {groups} and {finished[commits]}"
                    for fewer in (c for c in finished if c < commits):
                        assert finished[fewer] <= groups, "a branch was lost"
            except AssertionError as error:
                sys.exit(f"{kind}, {mode} at change {at} of {reference.changes}{', older result' if old else ''}: {error}")
        path = os.path.join(self.folder, f"fault-{kind}.h5")
        status, _, error = run(self.program, kind, path)
        if status != 0 or not all(same(v, reference.tables[n]) for n, v in tables(path).items() if n.startswith("branches/")):
            sys.exit(f"{kind}: the run after a fault ends otherwise: status {status} {error}")
        if os.path.exists(path + ".unfinished"):
            sys.exit(f"{kind}: an unfinished file stays after a complete run")
        print(f"{kind}: {runs} faults at {reference.changes} changes: 0 unreadable, 0 lost; {states} states of the new run with {kept} branches; "
              f"{time.monotonic() - begun:.0f} s", flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("shim")
    parser.add_argument("--runs", type=int, default=8)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", nargs="*", default=list(KINDS))
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="whirl-faults-") as folder:
        checker = Checker(os.path.abspath(options.program), os.path.abspath(options.shim), folder)
        for kind in options.kinds:
            checker.kind(kind, options.runs, random.Random(f"{options.seed} {kind}"))


main()
