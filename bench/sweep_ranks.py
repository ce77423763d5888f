#!/usr/bin/env python3
"""Points per second of `thimble sweep` against ranks, in turns: each round runs all numbers of ranks once, one after the other.

usage: sweep_ranks.py BIN_FOLDER [ROUNDS]

Efficiency is speed over ranks times the speed of one rank, of the same round; processor time says what the machine's other work
does not disturb. Prints Markdown.
"""

import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time

RANKS = (1, 2, 4)
MAPS = {  # what, how many cells, of what
    "passive hand": (10000, ["--delay-s", "0:0.2:100", "--contact-stiffness-N-per-m", "50:20000:100"]),
    "virtual operator": (100, ["--operator", "virtual", "--compensator", "none,CF", "--delay-s", "0:0.1:10",
                               "--gain", "0.1:1:5", "--trials", "5"]),
}
MPIRUN = ["mpirun", "--allow-run-as-root", "--oversubscribe", "--bind-to", "none", "-n"]


def run(programs, ranks, words, out):
    """Wall and processor seconds of one map."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start = time.monotonic()
    subprocess.run([*MPIRUN, str(ranks), os.path.join(programs, "thimble-sweep-mpi"), *words, "--out", out],
                   check=True, stdout=subprocess.DEVNULL)
    wall = time.monotonic() - start
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def measure(programs, rounds, cells, words):
    """A row per number of ranks."""
    times = {ranks: [] for ranks in RANKS}
    with tempfile.TemporaryDirectory() as folder:
        for turn in range(rounds):
            for ranks in RANKS:
                times[ranks].append(run(programs, ranks, words, os.path.join(folder, f"{turn}-{ranks}")))
    for ranks in RANKS:
        ratios = [one[0] / (ranks * many[0]) for one, many in zip(times[1], times[ranks])]
        speed = statistics.median(cells / wall for wall, _ in times[ranks])
        processor = statistics.median(cpu for _, cpu in times[ranks])
        yield (f"{ranks} | {speed:.4g} | {statistics.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f}) "
               f"| {processor:.2f}")


def main():
    programs = sys.argv[1]
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 5
    print("| cells of | ranks | cells/s | efficiency, median of rounds (lowest to highest) | processor time, s |")
    print("|---|---|---|---|---|")
    for name, (cells, words) in MAPS.items():
        for row in measure(programs, rounds, cells, words):
            print(f"| {name} | {row} |", flush=True)


if __name__ == "__main__":
    main()
