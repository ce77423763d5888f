"""Includes point down, between rooms and inside a room between its sub-rooms. The tables below are the ranks.

usage: include_directions.py PROJECT_ROOT
"""

import re
import sys

from sources import RANKS, ROOTS, read_tree, report, room_of, without_comments

RANK = {room: rank for rank, rooms in enumerate(RANKS) for room in rooms}
# Sub-rooms, lowest first. "." is the room's own folder; where it is absent, that folder and its sub-rooms share a rank.
SUB_ROOMS = {
    "common": ("control", "reduction", "velocity", "security", "hid", "log", "csv", "runtime", "process", "ros2"),
    "netem": ("stages", "formats", "import", "profiles", "relay", "shell", "commands"),
    "master": ("operator", "devices"),
    "slave_sim": ("elements",),
    "cutaneous_node": ("fingertip", "can", "board", "touchdiver", "emulator"),
    "visual_node": ("gamepad", "window", "views"),
    "stability": (".",),
    "session": ("records", "clocks", "log", "settings", "launch", "run", "virtual", "participant", "play", "render", "observe"),
    "analysis": ("statistics", "text", "tables", "claims", "figures", ".", "report"),
    "study": ("ranks", ".", "compensators", "board", "fit", "maps", "power", "sweeps", "swarm"),
    "thimble": ("doctor", "link_test", "log", "commands", "."),
}
# Made by flatc from common/messages.fbs. The wire structs end at the codec.
GENERATED = {"messages_generated.h": ("common",), "messages_bfbs_generated.h": ("common",)}

_INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*(["<])([^">\n]+)[">]', re.MULTILINE)


def sub_room_of(path):
    return path.split("/")[1] if path.count("/") > 1 else "."


def wrong_way(path, target):
    """What is wrong with the direction, or None."""
    room, target_room = room_of(path), room_of(target)
    if room != target_room:
        return f"{room}/ must not know {target_room}/" if RANK[target_room] >= RANK[room] else None
    order, here, there = SUB_ROOMS.get(room, ()), sub_room_of(path), sub_room_of(target)
    if here == there or ("." in (here, there) and "." not in order) or room not in SUB_ROOMS:
        return None
    if missing := [name for name in (here, there) if name not in order]:
        return f"{room}/{missing[0]} has no rank in SUB_ROOMS"
    return f"{room}/{here} must not know {room}/{there}" if order.index(there) > order.index(here) else None


def complaint(path, quoted, target, tree):
    """What is wrong with one #include of one file, or None."""
    if target in GENERATED:
        return None if room_of(path) in GENERATED[target] else f"{target} belongs to {', '.join(GENERATED[target])}"
    if not quoted:
        return f'a project header in <>: write "{target}"' if target in tree else None
    if room_of(target) not in ROOTS or target not in tree:
        return f'"{target}" is not written from the project\'s root, or does not exist'
    why = wrong_way(path, target)
    return f'{why} ("{target}")' if why else None


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
