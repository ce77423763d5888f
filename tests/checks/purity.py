"""What logic must not name: clocks, sockets, files, the machine's own random numbers, functions whose bits depend on the machine,
JSON's writer that throws.

usage: purity.py PROJECT_ROOT

Names, not meanings: a file that gets a clock under another name passes here and must not pass review.
"""

import re
import sys
from typing import NamedTuple

from sources import ROOMS, code_only, read_tree, report, room_of


def is_runtime(path):
    return path.startswith("common/runtime/")


def is_node(path):
    return path.rsplit(".", 1)[0].endswith("_node")


def is_process(path):
    return path.rsplit(".", 1)[0].endswith("_process")


def is_drawing(path):
    return path.startswith(("visual_node/window/", "visual_node/views/"))


# Each of these has variants by the CPU, or is open to a library in its last bits. sqrt, fma, floor, fmod, ldexp and the like are exact.
ELEMENTARY = r"""(?:exp[2m]?1?0?|log(?:2|10|1p)?|a?(?:sin|cos|tan)h?|atan2|sincos|pow|cbrt|hypot|erfc?|[tl]gamma(?:_r)?
                  |polar|expint|riemann_zeta)[fl]?"""


class Rule(NamedTuple):
    name: str
    applies: object  # path -> bool
    words: re.Pattern


RULES = (
    Rule(
        "a clock (now is an argument; only common/runtime/ reads one)",
        lambda path: not is_runtime(path),
        re.compile(
            r"""\b(?:steady_clock|system_clock|high_resolution_clock|utc_clock|file_clock)\b
              | \b(?:clock_gettime|clock_nanosleep|gettimeofday|timespec_get|timerfd_create)\b
              | \b(?:sleep_for|sleep_until|nanosleep|usleep)\b | \bsleep\s*\( | \bclock\s*\(\s*\)
              | \btime\s*\(\s*(?:nullptr|NULL|0|&) | \b__rdtscp?\b | \b_mm_?rdtsc""",
            re.VERBOSE,
        ),
    ),
    Rule(
        "a socket (channels are handed in)",
        lambda path: is_node(path) or is_process(path),
        re.compile(r"<sys/socket\.h>|<netinet/|<boost/asio|\b(?:socket|recv|recvfrom|recvmsg|sendto|sendmsg)\s*\("),
    ),
    Rule(
        "a file (nodes read and write none)",
        is_node,
        re.compile(r"<(?:fstream|filesystem|cstdio|fcntl\.h)>|\b[io]?fstream\b|\bfopen\s*\(|\bfilesystem\b"),
    ),
    Rule(
        "the machine's random numbers (RandomStream has the seeded ones)",
        lambda path: not is_runtime(path),
        re.compile(r"\brandom_device\b|\bs?rand\s*\(|\bgetrandom\s*\(|\bgetentropy\s*\("),
    ),
    Rule(
        "numbers that differ between libraries (std:: distributions, long double)",
        lambda path: True,
        re.compile(r"\bstd::\w+_distribution\b|\blong\s+double\b"),
    ),
    Rule(
        "a function whose last bits depend on the machine (common/math/portable.hpp has those that do not)",
        lambda path: not is_drawing(path),
        re.compile(rf"\bstd::{ELEMENTARY}\b(?=\s*[(;,)])|\bstd::complex\b|<(?:complex|math\.h)>", re.VERBOSE),
    ),
    # Numbers of sixty digits have functions of these names too, which are found without a prefix.
    Rule(
        "a function of C, whose last bits depend on the machine (common/math/portable.hpp has those that do not)",
        lambda path: not is_drawing(path) and not path.startswith(("stability/", "common/math/")),
        re.compile(rf"(?<![\w:.>~])(?<!double )(?:::)?{ELEMENTARY}\s*\((?!\s*\))", re.VERBOSE),
    ),
    Rule(
        "a JSON writer that throws at a path that is no UTF-8 (json_text() does not)",
        lambda path: path != "common/json_text.hpp",
        re.compile(r"\.\s*dump\s*\("),
    ),
)


def check(tree):
    findings = []
    for path, text in tree.items():
        if room_of(path) not in ROOMS:
            continue
        for number, line in enumerate(code_only(text).split("\n"), start=1):
            for rule in RULES:
                if rule.applies(path) and (match := rule.words.search(line)):
                    findings.append(f"{path}:{number}: {match[0].strip()} is {rule.name}")
    return findings


if __name__ == "__main__":
    sources = read_tree(sys.argv[1])
    sys.exit(report(check(sources), len(sources), "purity"))
