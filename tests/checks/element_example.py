"""The element type that docs/scenes.md prints, as files that a compiler takes.

usage: element_example.py PROJECT_ROOT OUT

Writes OUT/printed_element.cpp, the printed file, and OUT/slave_sim/element_types.hpp, the project's with the printed line
in its list. Ends with 1 if the page does not print exactly one such file and one such line, of one name.
"""

import pathlib
import re
import sys

PAGE = "docs/scenes.md"
LIST = "slave_sim/element_types.hpp"

_HEADING = "## Adding an element type\n"
_BLOCK = re.compile(r"^```cpp\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_LINE = re.compile(r" {4}ELEMENT\((\w+)\)\n")
_LAST_OF_LIST = re.compile(r"^ +ELEMENT\(\w+\)$", re.MULTILINE)


class Mismatch(Exception):
    pass


def only(things, what):
    if len(things) != 1:
        raise Mismatch(f"{len(things)} {what}, expected one")
    return things[0]


def printed(page):
    """(the file, the line) of the section on adding an element type."""
    sections = [part.split("\n## ")[0] for part in page.split(_HEADING)[1:]]
    blocks = _BLOCK.findall(only(sections, f"sections '{_HEADING.strip()}' in {PAGE}"))
    line = only([block for block in blocks if _LINE.fullmatch(block)], f"blocks with just a line ELEMENT(name) in {PAGE}")
    text = only([block for block in blocks if block != line], f"blocks with an element's file in {PAGE}")
    name = _LINE.fullmatch(line)[1]
    if f"void read_{name}(" not in text:
        raise Mismatch(f"{PAGE} registers {name}, but the file it prints has no read_{name}()")
    return text, line


def registered(header, line):
    """The header with the line at the end of its list."""
    if line.strip() in header:
        raise Mismatch(f"{LIST} has {line.strip()} already: print another element")
    last = only(_LAST_OF_LIST.findall(header), f"ends of the list in {LIST}")
    return header.replace(f"{last}\n", f"{last} \\\n{line}")


def make(page, header):
    """{path: text} of the files to write."""
    text, line = printed(page)
    return {"printed_element.cpp": text, LIST: registered(header, line)}


def main(root, out):
    try:
        files = make((root / PAGE).read_text(encoding="utf-8"), (root / LIST).read_text(encoding="utf-8"))
    except Mismatch as mismatch:
        print(mismatch, file=sys.stderr)
        return 1
    for path, text in files.items():
        (out / path).parent.mkdir(parents=True, exist_ok=True)
        (out / path).write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])))
