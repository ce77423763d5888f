"""The parts that docs/contributing.md adds, as files that a compiler takes.

usage: additions.py PROJECT_ROOT OUT

Writes into OUT every file that the page prints, and every file of the project that it changes, with the changes. Ends with 1
if a change does not find its place in the file exactly once.
"""

import pathlib
import re
import sys

PAGE = "docs/contributing.md"

_NEW = re.compile(r"`([\w/]+\.[ch]pp)`:\n\n```cpp\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_DIFF = re.compile(r"^```diff\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_CODE = re.compile(r"^```cpp$", re.MULTILINE)


class Mismatch(Exception):
    pass


def new_files(page):
    """{path: text} of the files that the page prints."""
    files = dict(_NEW.findall(page))
    if len(files) != len(_CODE.findall(page)):
        raise Mismatch(f"{PAGE}: a block of C++ has no line before it that ends in `path`:, or its path twice")
    return files


def changes(page):
    """(path, old lines, new lines) of each change, in the order of the page."""
    for block in _DIFF.findall(page):
        for part in re.split(r"^\+\+\+ ", block, flags=re.MULTILINE)[1:]:
            path, _, hunks = part.partition("\n")
            for hunk in re.split(r"^@@\n", hunks, flags=re.MULTILINE):
                lines = hunk.splitlines(keepends=True)
                yield path, *("".join(line[1:] for line in lines if line[0] in kinds) for kinds in (" -", " +"))


def changed(path, text, old, new):
    """The text with `new` in the place of the lines `old`."""
    count = f"\n{text}".count(f"\n{old}")
    if not old or count != 1:
        raise Mismatch(f"{PAGE} changes {path} at lines that are there {count} times, expected once:\n{old}")
    return f"\n{text}".replace(f"\n{old}", f"\n{new}")[1:]


def make(page, read):
    """{path: text} of all files of the page; read(path) gives one of the project, or None."""
    files = new_files(page)
    for path in files:
        if read(path) is not None:
            raise Mismatch(f"{PAGE} prints {path}, which the project has: print another")
    for path, old, new in changes(page):
        text = files.get(path) or read(path)
        if text is None:
            raise Mismatch(f"{PAGE} changes {path}, which is not there")
        files[path] = changed(path, text, old, new)
    return files


def main(root, out):
    def read(path):
        return (root / path).read_text(encoding="utf-8") if (root / path).exists() else None

    try:
        files = make(read(PAGE), read)
    except Mismatch as mismatch:
        print(mismatch, file=sys.stderr)
        return 1
    for path, text in files.items():
        (out / path).parent.mkdir(parents=True, exist_ok=True)
        (out / path).write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])))
