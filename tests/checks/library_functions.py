"""Which elementary functions the libraries take from the C library: none but those that draw.

usage: library_functions.py PROJECT_ROOT BUILD_FOLDER

purity.py reads sources. This reads what was compiled, and so also sees what Boost's templates call.
"""

import pathlib
import re
import subprocess
import sys

from purity import ELEMENTARY, is_drawing
from sources import ROOMS, report

NAME = re.compile(ELEMENTARY, re.VERBOSE)
# Boost.Multiprecision begins Newton's method with them; sixty digits come out, whatever they give.
FIRST_GUESSES = {"asinl", "atanf"}


def names_taken(words):
    """Of what `nm -u` prints: the elementary functions."""
    taken = {line.split()[-1] for line in words.splitlines() if line.strip().startswith("U ")}
    return sorted(name for name in taken - FIRST_GUESSES if NAME.fullmatch(name))


def check(build):
    libraries = [path for room in ROOMS for path in sorted((build / room).rglob("libthimble_*.a"))]
    findings = []
    for path in libraries:
        name = path.relative_to(build).as_posix()
        words = subprocess.run(["nm", "-u", path], check=True, capture_output=True, text=True).stdout
        if not is_drawing(name):
            findings += [f"{name}: {taken} has other last digits on other machines (common/math has its own)" for taken in names_taken(words)]
    return findings, len(libraries)


if __name__ == "__main__":
    found, looked_at = check(pathlib.Path(sys.argv[2]))
    sys.exit(report(found, looked_at, "functions of the C library", of="libraries"))
