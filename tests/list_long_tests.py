#!/usr/bin/python3
"""list_long_tests.py LOG [SECONDS]: names of the tests that a Release ctest log gives more than so many seconds (default .4): tests/long_tests.txt.

The tests under the sanitizers leave them out (label "long"): there they take some thirty times longer.
"""
import re
import sys

LINE = re.compile(r"\s*\d+/\d+ Test\s+#\d+: (.*?) \.*\s*Passed\s+([\d.]+) sec")


def main():
    least = float(sys.argv[2]) if len(sys.argv) > 2 else 0.4
    found = (LINE.match(line) for line in open(sys.argv[1], errors="replace"))
    for name in sorted({m[1] for m in found if m and float(m[2]) > least}):
        print(name)


main()
