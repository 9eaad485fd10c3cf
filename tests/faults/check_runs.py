#!/usr/bin/python3
"""check_runs.py PROGRAM [--kinds KIND...]: short runs of every kind by a program built with sanitizers: each ends with status 0, none reports."""
import argparse
import os
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from test_json_output import BRIEF  # noqa: E402


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--kinds", nargs="*", default=list(BRIEF))
    options = parser.parse_args()
    program, failed = os.path.abspath(options.program), False
    with tempfile.TemporaryDirectory() as folder:
        for kind in options.kinds:
            start, study = time.monotonic(), os.path.join(folder, "my.toml")
            with open(study, "w") as file:
                file.write(subprocess.run([program, "init", kind], capture_output=True, text=True, check=True).stdout)
            command = [program, "run", study, "--json", "-o", os.path.join(folder, "r.h5")] + [w for s in BRIEF[kind] for w in ("--set", s)]
            done = subprocess.run(command, capture_output=True, text=True, timeout=3600)
            bad = done.returncode != 0 or "Sanitizer" in done.stderr or "runtime error" in done.stderr
            failed = failed or bad
            print(f"{kind}: {'FAILED' if bad else 'clean'}, {time.monotonic() - start:.0f} s", flush=True)
            if bad:
                print(done.stderr[-4000:], flush=True)
    sys.exit(failed)


main()
