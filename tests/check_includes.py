#!/usr/bin/env python3
"""Checks that includes follow the arrows of the design:

    studies -> models, continuation, core;   models -> core;   continuation -> core;   tests -> all

Includes in quotes start at the repository's root and name a file that exists. The C headers of SUNDIALS, HDF5 and NLopt, and the heavy
toml++ and CLI11, stay out of headers; core/sundials_handles.hpp alone may hold SUNDIALS', and only .cpp files include it.

    check_includes.py [ROOT]      one line for each fault; exit status 1 if there is any
"""

import pathlib
import re
import sys

MAY_INCLUDE = {
    "core": {"core"},
    "continuation": {"continuation", "core"},
    "models": {"models", "core"},
    "studies": {"studies", "models", "continuation", "core"},
    "tests": {"tests", "studies", "models", "continuation", "core"},
}
SUNDIALS = re.compile(r"(sundials|cvodes?|kinsol|idas?|arkode|nvector|sunlinsol|sunmatrix|sunnonlinsol)/")
CPP_ONLY = re.compile(r"hdf5|H5|nlopt|toml\+\+/|CLI/")
HANDLES = "core/sundials_handles.hpp"
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def faults_of(path, root):
    """Yields (line number, what is wrong) for one source file; path is relative to root."""
    folder, name, header = path.parts[0], path.as_posix(), path.suffix == ".hpp"
    for number, line in enumerate((root / path).read_text(encoding="utf-8").splitlines(), 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        quoted, target = match[1] == '"', match[2]
        first = target.split("/")[0]
        if header and SUNDIALS.match(target) and name != HANDLES:
            yield number, f"<{target}> belongs in a .cpp file (or {HANDLES})"
        if header and CPP_ONLY.match(target):
            yield number, f"<{target}> belongs in a .cpp file"
        if header and target == HANDLES:
            yield number, f"{HANDLES} is for .cpp files only"
        if first in MAY_INCLUDE and first not in MAY_INCLUDE[folder]:
            yield number, f"{folder} may not include {target}"
        if quoted and first not in MAY_INCLUDE:
            yield number, f'"{target}" does not start at the repository\'s root'
        elif quoted and not (root / target).is_file():
            yield number, f'"{target}" does not exist'
        elif not quoted and first in MAY_INCLUDE and (root / target).is_file():
            yield number, f"<{target}> is ours: in quotes"


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent).resolve()
    # A stranger's program (tests/consumer) includes what is installed; it is no part of the tree.
    files = [
        path.relative_to(root)
        for folder in MAY_INCLUDE
        for path in sorted((root / folder).rglob("*.[ch]pp"))
        if path.relative_to(root).parts[:2] != ("tests", "consumer")
    ]
    if not files:
        sys.exit(f"no sources under {root}")
    faults = [f"{path}:{number}: {what}" for path in files for number, what in faults_of(path, root)]
    print("\n".join(faults) or f"{len(files)} files, every include follows the arrows")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
