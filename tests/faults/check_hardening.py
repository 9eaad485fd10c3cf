#!/usr/bin/python3
"""check_hardening.py PROGRAM: the Release program has stack protectors and checked calls, everything it links is read-only after the start, no part of
its memory is written and executed, it can be loaded anywhere, and it looks for libraries where the system does only."""
import re
import subprocess
import sys


def readelf(*arguments):
    return subprocess.run(["readelf", "--wide", *arguments, sys.argv[1]], capture_output=True, text=True, check=True).stdout


header, dynamic, segments, symbols = readelf("--file-header"), readelf("--dynamic"), readelf("--program-headers"), readelf("--dyn-syms")
faults = []
for there, what in (
    (re.search(r"Type:\s+DYN", header), "cannot be loaded anywhere: no PIE"),
    ("GNU_RELRO" in segments, "no GNU_RELRO"),
    (re.search(r"BIND_NOW|FLAGS_1.*NOW", dynamic), "not bound at the start: RELRO is partial"),
    (not re.search(r"RPATH|RUNPATH", dynamic), "a RPATH or RUNPATH entry"),
    (re.search(r"GNU_STACK.* RW +0x", segments), "a stack that can be executed"),
    ("__stack_chk_fail" in symbols, "no stack protector"),
    (re.search(r"__\w+_chk@", symbols.replace("__stack_chk_fail", "")), "no checked calls (FORTIFY)"),
    ("TEXTREL" not in dynamic, "relocations in the code"),
):
    if not there:
        faults.append(what)
if faults:
    sys.exit(f"{sys.argv[1]}: {', '.join(faults)}")
