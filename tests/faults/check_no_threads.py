#!/usr/bin/python3
"""check_no_threads.py PROGRAM SHIM: runs where no thread is to be had end as others do, with the same numbers."""
import os
import subprocess
import sys
import tempfile

import h5py
import numpy as np

STUDIES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "studies")
CASES = [
    ("oresund-basins.toml", ["basins.resolution=[6, 6]"]),
    ("oresund-integrate.toml", ["integrate.omega=[1.65]", "integrate.starts=[3.0, 0.0]", "sweep.range=[]"]),
    ("catenary-forced.toml", ["response.points=20", "response.refine=false"]),
    ("veering.toml", ["veering.points=10"]),
]


def columns(program, name, settings, path, shim):
    command = [program, "run", os.path.join(STUDIES, name), "-q", "-o", path] + [word for s in settings for word in ("--set", s)]
    done = subprocess.run(command, env=dict(os.environ, **({"LD_PRELOAD": shim} if shim else {})), capture_output=True, text=True, timeout=600)
    if done.returncode != 0:
        sys.exit(f"{name}{' without threads' if shim else ''}: status {done.returncode}: {done.stderr}")
    found = {}
    with h5py.File(path, "r") as file:
        file.visititems(lambda at, node: found.update({at: node[()]}) if isinstance(node, h5py.Dataset) and node.ndim and node.dtype.kind == "f" else None)
    return found


program, shim = (os.path.abspath(p) for p in sys.argv[1:])
with tempfile.TemporaryDirectory() as folder:
    for name, settings in CASES:
        many, one = (columns(program, name, settings, os.path.join(folder, f"{bool(s)}.h5"), s) for s in (None, shim))
        if many.keys() != one.keys() or not many:
            sys.exit(f"{name}: other tables without threads")
        for at in many:
            if not np.array_equal(many[at], one[at], equal_nan=True):
                sys.exit(f"{name}: {at} differs without threads")
        print(f"{name}: {len(many)} columns agree")
