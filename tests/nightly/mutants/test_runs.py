"""Runs test programs with a mutant switched on, or with none."""

import os
import pathlib
import re
import signal
import subprocess
import tempfile
import threading
import time
from typing import NamedTuple

# ctest sets the same for these programs (tests/devices/preload.cmake).
SURROUNDINGS = {"unit_falcon_usb": {"LD_PRELOAD": "libumockdev-preload.so.0"}}
BYTES = 1 << 24  # one for each number that a mutant can have
FAILED = re.compile(r"^\[  FAILED  \] ([\w./]+)", re.MULTILINE)
BEGUN = re.compile(r"^\[ RUN      \] ([\w./]+)", re.MULTILINE)


_running, _stopping = set(), threading.Event()


class Run(NamedTuple):
    failed: str  # the first failed test; empty: all passed
    seconds: float
    output: str


def stop_all():
    """Ends what runs, from another thread; no run after that has a result."""
    _stopping.set()
    for child in list(_running):
        os.killpg(child.pid, signal.SIGKILL)


def _wait(child, timeout_s):
    """The output, and whether the child was still running at the end of the time."""
    _running.add(child)
    try:
        return child.communicate(timeout=0 if _stopping.is_set() else timeout_s)[0], False
    except subprocess.TimeoutExpired:
        os.killpg(child.pid, signal.SIGKILL)
        return child.communicate()[0], True
    finally:
        _running.discard(child)
        if _stopping.is_set():
            raise InterruptedError("stopped")


def run_program(program, timeout_s, environment, only=""):
    """A folder of its own for each run: two runs of one program at a time do not share files."""
    begin = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="mutant_") as folder:
        surroundings = {**os.environ, "RC_PARAMS": "seed=1", "TMPDIR": folder, **SURROUNDINGS.get(program.name, {}), **environment}
        command = [str(program), "--gtest_fail_fast", *([f"--gtest_filter={only}"] if only else [])]
        with subprocess.Popen(command, cwd=folder, env=surroundings, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, errors="replace", start_new_session=True) as child:
            output, late = _wait(child, timeout_s)
    failed = last_test(output, "timeout") if late else first_failure(output, child.returncode)
    return Run(failed, time.monotonic() - begin, output)


def last_test(output, why):
    return f"{(BEGUN.findall(output) or ['start'])[-1]} ({why})"


def first_failure(output, code):
    if code == 0:
        return ""
    failed = FAILED.search(output)
    return failed[1] if failed else last_test(output, f"exit code {code}")


def confirmed(program, timeout_s, environment):
    """A run whose failure repeats when its test runs alone: what the machine's load disturbed is no finding."""
    run = run_program(program, timeout_s, environment)
    for _ in range(3):
        test = run.failed.split(" ")[0]
        if not test or test == "start" or run_program(program, timeout_s, environment, only=test).failed:
            break
        timeout_s *= 2
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
