"""No file over 400 lines. (No function over 70: .clang-tidy counts those.)

usage: file_sizes.py PROJECT_ROOT
"""

import sys

from sources import read_tree, report

MAX_LINES = 400


def check(tree):
    sizes = ((path, text.count("\n")) for path, text in tree.items())
    return [f"{path}: {lines} lines, at most {MAX_LINES}" for path, lines in sizes if lines > MAX_LINES]


if __name__ == "__main__":
    sources = read_tree(sys.argv[1])
    sys.exit(report(check(sources), len(sources), "file sizes"))
