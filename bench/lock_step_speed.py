#!/usr/bin/env python3
"""How fast a session is by each clock, as the table of docs/clocks.md: one run, one row for each number of processes.

    bench/lock_step_speed.py build/release/bin [--rounds 3] [--skip-wall]

A row has the round with the least wall time. CPU time is that of all programs: beside other work it says more."""
import argparse
import json
import os
import pathlib
import subprocess
import tempfile
import time

SESSION = """[session]
modalities = ['HF', 'CF']
delays_s = [0.0, 0.05]
parallel_conditions = {}
[trial]
contact_hold_s = 0.5
[log]
messages = 'none'
"""
# processes, clock, conditions side by side, words
ROWS = [
    (6, 'wall', 1, 'one condition at a time'),
    (6, 'lock-step', 1, 'one condition at a time'),
    (12, 'lock-step', 2, 'two conditions side by side'),
    (1, 'virtual', 1, 'one after another'),
]


def cpu_s():
    spent = os.times()
    return spent.children_user + spent.children_system


def run(thimble, folder, clock, conditions):
    """Simulated, wall and CPU seconds of one run."""
    session = folder / 'session.toml'
    session.write_text(SESSION.format(conditions))
    out = folder / f'{clock}{conditions}_{time.monotonic_ns()}'
    before = cpu_s()
    done = subprocess.run([thimble, 'run', session, '--clock', clock, '--out', out], capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f'thimble run --clock {clock} ended with code {done.returncode}: {done.stderr}')
    summary = json.loads((out / 'summary.json').read_text())
    return summary['simulated_s'], summary['wall_s'], cpu_s() - before, (out / 'trials.csv').read_bytes()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('programs', type=pathlib.Path, help='folder of thimble and its nodes')
    parser.add_argument('--rounds', type=int, default=3, help='of lock-step and virtual')
    parser.add_argument('--skip-wall', action='store_true', help='the wall clock takes as long as it simulates')
    given = parser.parse_args()
    trials = set()
    print('| processes | clock | simulated | wall | CPU | times real time |\n| --- | --- | --- | --- | --- | --- |')
    with tempfile.TemporaryDirectory() as folder:
        for processes, clock, conditions, words in ROWS:
            if clock == 'wall' and given.skip_wall:
                continue
            rounds = 1 if clock == 'wall' else given.rounds
            runs = [run(given.programs / 'thimble', pathlib.Path(folder), clock, conditions) for _ in range(rounds)]
            simulated, wall, cpu, table = min(runs, key=lambda one: one[1])
            print(f'| {processes} | {clock}, {words} | {simulated:.1f} s | {wall:.1f} s | {cpu:.1f} s | {simulated / wall:.0f} |',
                  flush=True)
            if clock != 'wall':
                trials.add(table)
    if len(trials) != 1:
        raise SystemExit('lock-step and virtual time do not give the same bytes')


if __name__ == '__main__':
    main()
