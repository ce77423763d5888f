"""Runs test programs with a mutant switched on, or with none."""

import os
import pathlib
import re
import subprocess
import tempfile
import time
from typing import NamedTuple

BYTES = 1 << 24  # one for each number that a mutant can have
FAILED = re.compile(r"^\[  FAILED  \] ([\w./]+)", re.MULTILINE)
BEGUN = re.compile(r"^\[ RUN      \] ([\w./]+)", re.MULTILINE)


class Run(NamedTuple):
    failed: str  # the first failed test; empty: all passed
    seconds: float
    output: str


def run_program(program, timeout_s, environment, only=""):
    """A folder of its own for each run: two runs of one program at a time do not share files."""
    begin = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="mutant_") as folder:
        surroundings = {**os.environ, "RC_PARAMS": "seed=1", "TMPDIR": folder, **environment}
        command = [str(program), "--gtest_fail_fast", *([f"--gtest_filter={only}"] if only else [])]
        with subprocess.Popen(command, cwd=folder, env=surroundings, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, errors="replace", start_new_session=True) as child:
            try:
                output, _ = child.communicate(timeout=timeout_s)
            except BaseException as error:
                os.killpg(child.pid, 9)
                output, _ = child.communicate()
                if not isinstance(error, subprocess.TimeoutExpired):
                    raise
                return Run(f"{(BEGUN.findall(output) or ['start'])[-1]} (timeout)", time.monotonic() - begin, output)
    return Run(first_failure(output, child.returncode), time.monotonic() - begin, output)


def first_failure(output, code):
    if code == 0:
        return ""
    if failed := FAILED.search(output):
        return failed[1]
    return f"{(BEGUN.findall(output) or ['start'])[-1]} (exit code {code})"


def confirmed(program, timeout_s, environment, **options):
    """A run whose failure repeats when its test runs alone: what the machine's load disturbed is no finding."""
    run = run_program(program, timeout_s, environment, **options)
    for _ in range(3):
        test = run.failed.split(" ")[0]
        if not test or run.failed.endswith("(timeout)") or test == "start":
            break
        if run_program(program, timeout_s, environment, only=test).failed:
            break
        run = run_program(program, timeout_s, environment)
    return run


def reached_numbers(program, timeout_s):
    """A run without a mutant: what failed in it, how long it took, and the numbers of the mutants it reached."""
    with tempfile.NamedTemporaryFile(prefix="reached_") as table:
        table.truncate(BYTES)
        run = confirmed(program, timeout_s, {"THIMBLE_REACHED": table.name})
        data = pathlib.Path(table.name).read_bytes()
    numbers, at = [], data.find(1)
    while at >= 0:
        numbers.append(at)
        at = data.find(1, at + 1)
    return run, numbers
