"""Runs every property of the unit tests with fresh seeds, one per round. `.ci/run` and tests/nightly/proofs call it.

usage: properties.py BIN [ROUNDS]     (BIN: where the test programs are; 1 round)

Prints the seed of each round, and of each property that fails its output and the command that repeats it. Exit code 1
if one fails, or a program has none of the properties that its sources have.
"""

import concurrent.futures
import os
import pathlib
import re
import secrets
import subprocess
import sys

TESTS = pathlib.Path(__file__).resolve().parent.parent
TEST = re.compile(r"^\s*(TEST|TEST_F|TEST_P|RC_GTEST_PROP)\(\s*(\w+),\s*(\w+)|\brc::check\(", re.MULTILINE)
PROGRAM = re.compile(r"thimble_test\((\w+)\s+SOURCES\s([^)]*?)\sLINK\b")
FAILED = re.compile(r"^\[  FAILED  \] ([\w/]+\.[\w/]+)", re.MULTILINE)
FAILURE = re.compile(r"Falsifiable|Gave up|: Failure$")
MOST_S = 300  # of one program in one round
MOST_LINES = 30  # of the output of one that fails, from its first failure on


def properties_of(path):
    """GoogleTest filters of the tests in a file that call RapidCheck."""
    found, test = set(), None
    for match in TEST.finditer(path.read_text(encoding="utf-8")):
        kind, suite, name = match.groups()
        if kind:
            test = f"*{suite}.{name}*" if kind == "TEST_P" else f"{suite}.{name}"
        if not kind or kind == "RC_GTEST_PROP":
            found.add(test)
    return found


def programs():
    """{program: filters of its properties}, from the sources that its CMakeLists.txt names."""
    found = {}
    for listing in sorted(TESTS.rglob("CMakeLists.txt")):
        for program, sources in PROGRAM.findall(listing.read_text(encoding="utf-8")):
            files = [listing.parent / source for source in sources.split() if source.endswith("_test.cpp")]
            if filters := sorted(set().union(*map(properties_of, files))):
                found[program] = filters
    return found


def misses_some(program, filters):
    """Whether the program has fewer tests than the sources have properties: then nothing would fail here."""
    listed = subprocess.run([program, f"--gtest_filter={':'.join(filters)}", "--gtest_list_tests"],
                            capture_output=True, text=True, check=True)
    return sum(line.startswith("  ") for line in listed.stdout.splitlines()) < len(filters)


def run(program, filters, seed):
    """What to print about one that fails, or None."""
    command = [program, f"--gtest_filter={':'.join(filters)}", "--gtest_brief=1"]
    environment = {**os.environ, "RC_PARAMS": f"seed={seed}"}
    try:
        ended = subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, text=True, errors="replace", timeout=MOST_S, check=False)
    except subprocess.TimeoutExpired:
        return repeat(seed, program, filters, [f"not done after {MOST_S} s"])
    if ended.returncode == 0:
        return None
    failed = sorted(set(FAILED.findall(ended.stdout))) or filters
    lines = ended.stdout.splitlines()
    first = next((i for i, line in enumerate(lines) if FAILURE.search(line)), 0)
    return repeat(seed, program, failed, lines[first:first + MOST_LINES])


def repeat(seed, program, filters, lines):
    commands = [f"RC_PARAMS=seed={seed} {program} --gtest_filter='{each}'" for each in filters]
    return "\n".join([*(line[:300] for line in lines), "repeat it with:", *commands])


def main(folder, rounds):
    all_of_them = programs()
    built = {f"{folder}/{name}": filters for name, filters in all_of_them.items()
             if os.access(f"{folder}/{name}", os.X_OK)}
    for name in sorted(set(all_of_them) - {os.path.basename(path) for path in built}):
        print(f"not built, not run: {name}")
    lacking = [path for path, filters in built.items() if misses_some(path, filters)]
    for path in lacking:
        print(f"{path} lacks properties of its sources: build it")
    failures = len(lacking)
    by_length = sorted(built.items(), key=lambda item: -len(item[1]))  # the longest first, by the number of properties
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for _ in range(rounds):
            seed = secrets.randbits(64)
            print(f"seed {seed}", flush=True)
            for told in pool.map(lambda item: run(*item, seed), by_length):
                if told:
                    failures += 1
                    print(told, flush=True)
    print(f"{sum(map(len, built.values()))} properties of {len(built)} programs, fresh seeds: {rounds}, "
          f"failures: {failures}")
    return 1 if failures or not built else 0


if __name__ == "__main__":
    if not 2 <= len(sys.argv) <= 3:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], int(sys.argv[2]) if len(sys.argv) == 3 else 1))
