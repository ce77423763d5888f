"""Includes point one way: common <- {netem, nodes} <- experiment <- bench <- tests; no node knows another node.

usage: include_directions.py PROJECT_ROOT
"""

import re
import sys

from sources import NODE_ROOMS, ROOMS, ROOTS, read_tree, report, room_of, without_comments

ALLOWED = {
    "common": {"common"},
    **{room: {"common", room} for room in NODE_ROOMS},
    "experiment": set(ROOMS),
    "bench": {*ROOMS, "bench"},
    "tests": {*ROOMS, "bench", "tests"},
}
# Made by flatc from common/messages.fbs. The wire structs end at the codec.
GENERATED = {"messages_generated.h": ("common",), "messages_bfbs_generated.h": ("common",)}

_INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*(["<])([^">\n]+)[">]', re.MULTILINE)


def complaint(path, quoted, target, tree):
    """What is wrong with one #include of one file, or None."""
    room, target_room = room_of(path), room_of(target)
    if target in GENERATED:
        return None if room in GENERATED[target] else f"{target} belongs to {', '.join(GENERATED[target])}"
    if not quoted:
        return f'a project header in <>: write "{target}"' if target in tree else None
    if target_room not in ROOTS or target not in tree:
        return f'"{target}" is not written from the project\'s root, or does not exist'
    if target_room not in ALLOWED[room]:
        return f"{room}/ must not know {target_room}/ (\"{target}\")"
    return None


def check(tree):
    findings = []
    for path, text in tree.items():
        text = without_comments(text)
        for match in _INCLUDE.finditer(text):
            why = complaint(path, match[1] == '"', match[2], tree)
            if why:
                line = text.count("\n", 0, match.start(2)) + 1
                findings.append(f"{path}:{line}: {why}")
    return findings


if __name__ == "__main__":
    sources = read_tree(sys.argv[1])
    sys.exit(report(check(sources), len(sources), "include directions"))
