#!/usr/bin/python3
"""check_signals.py PROGRAM [--within S] [--kinds KIND...]: stops runs of every kind by SIGINT, SIGTERM and SIGHUP.

Each must end within S seconds (default 1) with status 130, its result unreadable never: no file, or a file whose outcome is "interrupted", whose tables
`export` writes. Kinds whose runs end by themselves before the signal comes are told.
"""
import argparse
import os
import signal
import subprocess
import sys
import tempfile
import time

import h5py

STUDIES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "studies")
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)

# An input of each kind, and what makes its run last.
KINDS = {
    "superharmonic": ("oresund-superharmonic.toml", []),
    "continuation": ("lorenz.toml", []),
    "cycles": ("roessler-cycles.toml", []),
    "two-parameter": ("oresund-threshold.toml", []),
    "periodic": ("oresund-periodic.toml", []),
    "slow-flow": ("oresund-combinatorial.toml", []),
    "compare": ("oresund-compare.toml", []),
    "integrate": ("oresund-integrate.toml", []),
    "basins": ("oresund-basins.toml", []),
    "mode-convergence": ("oresund-mode-convergence.toml", []),
    "catenary-modes": ("catenary-modes.toml", ["sweep.points=5000"]),
    "catenary-forced": ("catenary-forced.toml", ["response.points=20000"]),
    "veering": ("veering.toml", ["veering.points=5000"]),
    "guy-modes": ("okc-guy-modes.toml", ["modes.count=60"]),
    "guy-stiffness": ("okc-guy-stiffness.toml", ["stiffness.points=100000"]),
}


def begun(run, path):
    """Waits until the run has its file, and half a second more; false if it ended before."""
    for _ in range(600):
        if os.path.exists(path + ".unfinished") or os.path.exists(path):
            time.sleep(0.5)
            break
        if run.poll() is not None:
            break
        time.sleep(0.02)
    return run.poll() is None


def check(program, kind, number, folder, within):
    """Seconds from the signal to the end, None if the run ended by itself."""
    path = os.path.join(folder, f"{kind}-{number.name}.h5")
    name, settings = KINDS[kind]
    command = [program, "run", os.path.join(STUDIES, name), "-q", "-o", path] + [word for s in settings for word in ("--set", s)]
    run = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if not begun(run, path):
        error = run.communicate()[1]
        assert run.returncode == 0, f"status {run.returncode}: {error}"
        return None
    start = time.monotonic()
    run.send_signal(number)
    error = run.communicate(timeout=60)[1]
    took = time.monotonic() - start
    if run.returncode == 0:  # it was ending already
        return None
    assert run.returncode == 130, f"status {run.returncode}: {error}"
    assert took < within, f"{took:.2f} s until the end"
    assert not os.path.exists(path + ".unfinished"), "an unfinished file stays"
    if os.path.exists(path):
        with h5py.File(path, "r") as file:
            study = file["study"].attrs
            assert study["outcome"] == "interrupted" and len(study["stop_reasons"]) > 0, f"outcome {study['outcome']}"
        subprocess.run([program, "export", path, "-o", os.path.join(folder, "csv")], check=True, capture_output=True, timeout=600)
    return took


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--within", type=float, default=1.0)
    parser.add_argument("--kinds", nargs="*", default=list(KINDS))
    options = parser.parse_args()
    failed = False
    with tempfile.TemporaryDirectory(prefix="whirl-signals-") as folder:
        for kind in options.kinds:
            for number in SIGNALS:
                try:
                    took = check(os.path.abspath(options.program), kind, number, folder, options.within)
                    print(f"{kind}, {number.name}: " + ("ended by itself" if took is None else f"{took:.2f} s"), flush=True)
                except (AssertionError, subprocess.SubprocessError, OSError, KeyError) as error:
                    print(f"{kind}, {number.name}: FAILED: {error}", flush=True)
                    failed = True
    sys.exit(failed)


main()
