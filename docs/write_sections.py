#!/usr/bin/python3
"""write_sections.py PROGRAM [--check]: docs/sections.md from what `whirl init` prints for every kind; --check compares and writes nothing."""
import os
import re
import subprocess
import sys

PAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "sections.md")
HEAD = """# Keys of study files

Written by `docs/write_sections.py` from the schemas that `whirl init KIND` prints; a test compares. A study file is TOML: `study = "KIND"`, then sections. Any key can be set on
the command line, `--set section.key=value`; what is required and not given, or unknown, is refused with the nearest name.

"""


def output(program, *arguments):
    return subprocess.run([program, *arguments], check=True, capture_output=True, text=True).stdout


def entries(text):
    """(section, key, "meaning", "range; default") of each key, and (section, None, free text, "") of a block that is only described."""
    section, comment, block = "", None, None
    for line in text.splitlines()[2:]:
        if block is not None:
            block.append(line)
            continue
        described = re.fullmatch(r"# \[(\w+)\] (.*)", line)
        if described:
            block = [line]
        elif re.fullmatch(r"\[(\w+)\]", line):
            section = line[1:-1]
        elif comment and re.match(r"(# )?\w+ =", line):
            key = re.match(r"(?:# )?(\w+) =", line).group(1)
            meaning, what = re.fullmatch(r"(.*?): ((?:an? |one of |true or false).*)", comment).groups()
            yield section, key, meaning, what
            comment = None
        elif line.startswith("# "):
            comment = line[2:]
    if block:
        yield "", None, "\n".join(block), ""


def page(program):
    kinds = [line.split()[0] for line in output(program, "list").splitlines()]
    found, blocks, order = {}, {}, []
    for kind in kinds:
        for section, key, meaning, what in entries(output(program, "init", kind)):
            if key is None:
                blocks.setdefault(meaning, []).append(kind)
                continue
            if section not in order:
                order.append(section)
            found.setdefault(section, {}).setdefault((key, meaning, what), []).append(kind)
    text = HEAD
    for section in order:
        text += f"## {'[' + section + ']' if section else 'Before the first section'}\n\n| key | meaning | value | kinds |\n|---|---|---|---|\n"
        for (key, meaning, what), users in found[section].items():
            cells = [f"`{key}`", meaning, what, "all" if len(users) == len(kinds) else ", ".join(users)]
            text += "| " + " | ".join(c.replace("|", "\\|") for c in cells) + " |\n"
        text += "\n"
    for block, users in blocks.items():
        text += f"## Blocks of {', '.join(users)}\n\n" + "\n".join("    " + line for line in block.splitlines()) + "\n\n"
    return text.rstrip("\n") + "\n"


def main():
    text = page(sys.argv[1])
    if "--check" not in sys.argv:
        open(PAGE, "w").write(text)
    elif open(PAGE).read() != text:
        sys.exit("docs/sections.md is not what the schemas say: run docs/write_sections.py build/studies/whirl")


main()
