#!/usr/bin/env python3
"""Checks that each key cited in brackets, as [NielsenKirkegaard2002, eq. (30)] or [Gale1976; Sarvi1968], has one entry in references.bib.

    check_citations.py [ROOT]     one line for each fault; exit status 1 if there is any
"""

import pathlib
import re
import sys

FOLDERS = ["core", "continuation", "models", "studies", "tests", "plots-scripts", "docs", "."]  # "." without its subfolders
SUFFIXES = {".cpp", ".hpp", ".py", ".md", ".toml"}
BRACKET = re.compile(r"\[([^\[\]]*)\]")
KEY = re.compile(r"\b[A-Z][A-Za-z]+(?:18|19|20)[0-9]{2}[a-z]?\b")
ENTRY = re.compile(r"^\s*@\w+\s*\{\s*([^,\s]+)\s*,", re.MULTILINE)


def sources(root):
    for folder in FOLDERS:
        for path in sorted((root / folder).glob("*" if folder == "." else "**/*")):
            if path.is_file() and (path.suffix in SUFFIXES or path.name == "plot") and path != pathlib.Path(__file__).resolve():
                yield path


def citations(text):
    """Yields (line number, key); a bracket may run over a line's end."""
    for bracket in BRACKET.finditer(text):
        for key in KEY.finditer(bracket[1]):
            yield text.count("\n", 0, bracket.start(1) + key.start()) + 1, key[0]


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent).resolve()
    entries = ENTRY.findall((root / "references.bib").read_text(encoding="utf-8"))
    faults = [f"references.bib: {key} stands more than once" for key in sorted(set(entries)) if entries.count(key) > 1]
    cited = 0
    for path in sources(root):
        for number, key in citations(path.read_text(encoding="utf-8")):
            cited += 1
            if key not in entries:
                faults.append(f"{path.relative_to(root)}:{number}: [{key}] is not in references.bib")
    if cited == 0:
        faults.append(f"no citation found under {root}")
    print("\n".join(faults) or f"{cited} citations, all in references.bib")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
