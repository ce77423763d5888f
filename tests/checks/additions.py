"""The parts that the patches of examples/additions add, as files that a compiler takes.

usage: additions.py PROJECT_ROOT OUT

Writes into OUT every file that a patch makes or changes, with its changes. Ends with 1 if a change does not find its place
in the file exactly once: then `git apply` may fail, or change another place.
"""

import pathlib
import re
import sys

_FILE = re.compile(r"^--- (\S+)\n\+\+\+ b/(\S+)\n", re.MULTILINE)
_HUNK = re.compile(r"^@@ -\d+(?:,(\d+))? \+\d+(?:,(\d+))? @@.*\n", re.MULTILINE)


class Mismatch(Exception):
    pass


def changes(patch):
    """(path, whether the file is new, old lines, new lines) of each change, in the order of the patch."""
    _, *parts = _FILE.split(patch)
    for before, path, text in zip(parts[::3], parts[1::3], parts[2::3]):
        stray, *hunks = _HUNK.split(text)
        if stray:
            raise Mismatch(f"a patch changes {path} at no place:\n{stray}")
        for old_count, new_count, hunk in zip(hunks[::3], hunks[1::3], hunks[2::3]):
            old, new = ([line[1:] for line in hunk.splitlines(keepends=True) if line[0] in kinds] for kinds in (" -", " +"))
            if [len(old), len(new)] != [int(count or 1) for count in (old_count, new_count)]:
                raise Mismatch(f"a patch changes {path} by other numbers of lines than it says:\n{hunk}")
            yield path, before == "/dev/null", "".join(old), "".join(new)


def changed(path, text, old, new):
    """The text with `new` in the place of the lines `old`."""
    count = f"\n{text}".count(f"\n{old}")
    if not old or count != 1:
        raise Mismatch(f"a patch changes {path} at lines that are there {count} times, expected once:\n{old}")
    return f"\n{text}".replace(f"\n{old}", f"\n{new}")[1:]


def make(patches, read):
    """{path: text} of all files of the patches; read(path) gives one of the project, or None."""
    files = {}
    for path, is_new, old, new in (change for patch in patches for change in changes(patch)):
        text = files.get(path) or read(path)
        if is_new != (text is None):
            raise Mismatch(f"a patch {'makes' if is_new else 'changes'} {path}, which is {'' if is_new else 'not '}there")
        files[path] = new if is_new else changed(path, text, old, new)
    if not files:
        raise Mismatch("no patch changes anything")
    return files


def main(root, out):
    def read(path):
        return (root / path).read_text(encoding="utf-8") if (root / path).exists() else None

    try:
        patches = sorted((root / "examples/additions").glob("*.patch"))
        files = make([patch.read_text(encoding="utf-8") for patch in patches], read)
    except Mismatch as mismatch:
        print(mismatch, file=sys.stderr)
        return 1
    for path, text in files.items():
        (out / path).parent.mkdir(parents=True, exist_ok=True)
        (out / path).write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])))
