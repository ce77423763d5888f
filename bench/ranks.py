#!/usr/bin/env python3
"""Two ranks against two threads: the rows per second of a board, in turns. Needs mpirun and two free cores.

bench/ranks.py build/release/bin/thimble [ROUNDS]
"""
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

MPIRUN = ('mpirun --allow-run-as-root --bind-to none -n 2'.split())
BOARD = 'board --quick --only HF,CF,scaled,wave,local-fixture,two-layer'.split()


def seconds(words, out):
    start = time.monotonic()
    subprocess.run([*words, '--overwrite', '--out', str(out)], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return time.monotonic() - start


def main():
    thimble, rounds = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 5
    with tempfile.TemporaryDirectory() as folder:
        threads_out, ranks_out = pathlib.Path(folder, 'threads'), pathlib.Path(folder, 'ranks')
        ratios = []
        for number in range(rounds):
            threads = seconds([thimble, *BOARD, '--jobs', '2'], threads_out)
            ranks = seconds([*MPIRUN, thimble, *BOARD], ranks_out)
            ratios.append(threads / ranks)
            print(f'round {number + 1}: two threads {threads:.2f} s, two ranks {ranks:.2f} s, efficiency {ratios[-1]:.2f}')
        same = (threads_out / 'board.csv').read_bytes() == (ranks_out / 'board.csv').read_bytes()
        print(f'median {statistics.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f}); same bytes: {"yes" if same else "NO"}')
    return 0 if same else 1


if __name__ == '__main__':
    sys.exit(main())
