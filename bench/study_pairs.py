#!/usr/bin/env python3
"""Speed of virtual time of two builds: pairs of the same study in turns, on one core.

    bench/study_pairs.py OLD/bin/thimble NEW/bin/thimble [--pairs 20] [-- OPTIONS OF STUDY]

A machine changes its speed within minutes, so only the ratio of a pair counts. User time is compared, not wall time."""
import argparse
import csv
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

STUDY = ['--experiment', '3', '--subjects', '3', '--no-control', '--seed', '1']


def user_s():
    return os.times().children_user


def study(thimble, options, out):
    """User seconds, simulated seconds of all trials, and the bytes of trials.csv."""
    before = user_s()
    done = subprocess.run([thimble, 'study', *options, '--jobs', '1', '--overwrite', '--out', out], capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f'{thimble} study ended with code {done.returncode}: {done.stderr}')
    spent = user_s() - before
    simulated = 0
    for name in out.glob('*.csv'):  # controls and compensators too; curves and subjects have no duration
        with open(name, newline='') as file:
            table = csv.DictReader(file)
            if 'duration_s' in table.fieldnames:
                simulated += sum(float(row['duration_s']) for row in table)
    return spent, simulated, (out / 'trials.csv').read_bytes()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('old', type=pathlib.Path)
    parser.add_argument('new', type=pathlib.Path)
    parser.add_argument('--pairs', type=int, default=20)
    words, options = sys.argv[1:], STUDY
    if '--' in words:
        words, options = words[:words.index('--')], words[words.index('--') + 1:]
    given = parser.parse_args(words)
    programs = [given.old.resolve(), given.new.resolve()]
    if given.pairs < 1:
        parser.error(f'--pairs {given.pairs}: at least 1')
    for program in programs:
        if not program.is_file():
            parser.error(f'{program}: there is no such program')
    runs = [[], []]
    with tempfile.TemporaryDirectory() as folder:
        for pair in range(given.pairs):
            for which in (0, 1) if pair % 2 else (1, 0):  # neither is always the first
                runs[which].append(study(programs[which], options, pathlib.Path(folder) / 'study'))
    print('| program | user time, least | median | times real time, best |\n| --- | ---: | ---: | ---: |')
    for program, its in zip(programs, runs):
        spent = [run[0] for run in its]
        print(f'| {program} | {min(spent):.2f} s | {statistics.median(spent):.2f} s | {its[0][1] / min(spent):.0f} |')
    ratios = [new[0] / old[0] for old, new in zip(*runs)]
    same = len({run[2] for its in runs for run in its}) == 1
    print(f'\nThe new program takes {statistics.median(ratios):.3f} of the time of the old one (median of {given.pairs} pairs). '
          f'trials.csv has {"the same" if same else "other"} bytes.')


if __name__ == '__main__':
    main()
