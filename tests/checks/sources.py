"""The project's own C++ files, and their text without what a compiler would not see."""

import pathlib
import re

NODE_ROOMS = ("netem", "master", "slave_sim", "cutaneous_node", "visual_node")
# Lowest first: each knows the ranks before its own. No node knows another node.
RANKS = (("common",), NODE_ROOMS, ("stability",), ("session",), ("analysis",), ("study",), ("thimble",), ("browser",), ("python",), ("bench",), ("tests",))
ROOTS = tuple(room for rank in RANKS for room in rank)
ROOMS = ROOTS[:-2]
SUFFIXES = (".hpp", ".h", ".cpp")


def read_tree(root):
    """{path from the root: text} of every C++ file of the project."""
    root = pathlib.Path(root)
    files = (path for room in ROOTS for path in (root / room).rglob("*"))
    return {
        path.relative_to(root).as_posix(): path.read_text(encoding="utf-8")
        for path in sorted(files)
        if path.suffix in SUFFIXES
    }


def room_of(path):
    return path.split("/")[0]


# In this order: what opens first hides the others. A quote after a digit separates digits.
HIDDEN = re.compile(
    r"""(?P<line_comment>//[^\n]*)
      | (?P<block_comment>/\*.*?\*/)
      | (?P<raw_string>R"(?P<fence>[^(\s]*)\(.*?\)(?P=fence)")
      | (?P<string>"(?:\\.|[^"\\\n])*")
      | (?P<character>(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])+')""",
    re.VERBOSE | re.DOTALL,
)


def _blank(match):
    return " " + "\n" * match.group().count("\n")


def without_comments(text):
    """Comments blanked, strings kept (an #include is one), line numbers unchanged."""
    return HIDDEN.sub(lambda m: _blank(m) if m.lastgroup.endswith("comment") else m.group(), text)


def code_only(text):
    """Comments, strings and characters blanked, line numbers unchanged."""
    return HIDDEN.sub(_blank, text)


def report(findings, looked_at, rule, of="files"):
    """Prints the findings; the exit code of a check. A check that saw nothing has not passed."""
    for finding in findings:
        print(finding)
    print(f"{rule}: {looked_at} {of}, {len(findings)} findings")
    return 1 if findings or looked_at == 0 else 0
