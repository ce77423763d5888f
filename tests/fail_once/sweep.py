"""Makes each call of a program fail once, and looks at how the program takes it.

usage: sweep.py BIN LIBRARY [CALLS] [SCENARIO...]

BIN: the programs; LIBRARY: fail_once; CALLS: how many of each kind to try in each scenario, spread over all (0: every one).
Promise: the program ends, not by a signal and not late, with an exit code of docs/programs.md. With 0 its files are those of a run
in which nothing fails, or what it prints. Otherwise it says why on stderr, and the rows that it kept are rows of that run.
"""

import concurrent.futures
import os
import pathlib
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from one_trial import one_trial, port_block  # noqa: E402

MOST_S = 60  # or so many times as long as a run in which nothing fails: a machine with much other work is slow
MOST_TIMES = 20
KINDS = ("alloc", "open", "read", "write", "fsync", "socket", "send", "receive", "rename")
CODES = (0, 1, 2, 3, 4, 5)
SESSION = one_trial(0.05, "[fixture]\nposition_m = 0.022\n")
RUN = ("run", "{session}", "--clock", "lock-step", "--out", "{out}", "--base-port", "{port}")
# By name: which program fails, the arguments of thimble, and the file that must be the same (None: what it prints).
SCENARIOS = {
    "check": ("thimble", ("check", "{session}"), None),
    "study": ("thimble", ("study", "{session}", "--subjects", "1", "--jobs", "1", "--out", "{out}"), "trials.csv"),
    "report": ("thimble", ("report", "--study", "{done}", "--out", "{out}"), "report.html"),
    "session": ("thimble", RUN, "trials.csv"),
    **{node: (f"thimble-{node}", RUN, "trials.csv")
       for node in ("slave-sim", "master", "cutaneous", "visual", "netem")},
}
CRASHED = ("ended with code 139", "ended with code 134", "ended with code 136", "terminate called", "Assertion")


class Sweep:
    def __init__(self, programs, library, folder):
        self.thimble, self.library, self.folder = f"{programs}/thimble", library, pathlib.Path(folder)
        self.most_s = MOST_S
        self.session = self.folder / "session.toml"
        self.session.write_text(SESSION)
        self.done = self.folder / "done"
        subprocess.run([self.thimble, "study", self.session, "--subjects", "1", "--out", self.done], check=True,
                       capture_output=True)

    def run(self, scenario, kind, call):
        """(exit code or None, words, the text to compare)"""
        program, words, file = SCENARIOS[scenario]
        out = self.folder / f"{scenario}-{kind}-{call}"
        env = {**os.environ, "LD_PRELOAD": self.library, "FAIL_ONCE_PROGRAM": program, "FAIL_ONCE_KIND": kind,
               "FAIL_ONCE_AT": str(call), "XDG_STATE_HOME": str(self.folder / "state"),
               "THIMBLE_STOP_DIR": str(self.folder)}
        if call == 0:
            env["FAIL_ONCE_COUNTS"] = str(self.folder / f"{scenario}.counts")
        try:
            with port_block() as port:
                filled = [word.format(session=self.session, out=out, done=self.done, port=port) for word in words]
                ended = subprocess.run([self.thimble, *filled], env=env, stdin=subprocess.DEVNULL, capture_output=True,
                                       text=True, errors="replace", timeout=self.most_s, check=False)
        except subprocess.TimeoutExpired as late:
            return None, str(late.stderr), ""
        if file is None:
            return ended.returncode, ended.stderr, ended.stdout
        text = (out / file).read_text() if (out / file).exists() else ""
        return ended.returncode, ended.stderr, text.replace(str(out), "OUT")  # a report has the command

    def counts(self, scenario):
        lines = (self.folder / f"{scenario}.counts").read_text().splitlines()
        return {kind: int(count) for kind, count in (line.split() for line in lines)}

    def complaint(self, scenario, kind, call, good):
        """What breaks the promise, or None."""
        code, words, text = self.run(scenario, kind, call)
        if code is None:
            return f"not done after {self.most_s:.0f} s: {words[-300:]}"
        if code not in CODES or any(sign in words for sign in CRASHED):
            return f"exit code {code}: {words[-400:]}"
        if code == 0:
            return None if text == good else "exit code 0 with other bytes"
        if not words.strip():
            return f"exit code {code} without a word"
        rows = text.splitlines()
        wrong = [row for row in rows[:-1] if row not in good.splitlines() and "completed" in row]
        return f"exit code {code} with a row that is not of the good run: {wrong[0]}" if wrong else None


def chosen(count, wanted):
    """Calls spread over all of them, the first and the last among them."""
    if wanted == 0 or count <= wanted:
        return range(1, count + 1)
    return sorted({1 + round(i * (count - 1) / max(1, wanted - 1)) for i in range(wanted)})


def main(programs, library, wanted, scenarios):
    failures = tried = 0
    with tempfile.TemporaryDirectory() as folder:
        sweep = Sweep(programs, os.path.abspath(library), folder)
        for scenario in scenarios:
            sweep.most_s, begin = 20 * MOST_S, time.monotonic()
            code, words, good = sweep.run(scenario, "none", 0)
            sweep.most_s = max(MOST_S, MOST_TIMES * (time.monotonic() - begin))
            if code != 0:
                sys.exit(f"{scenario}: exit code {code} though nothing fails: {words}")
            calls = [(kind, call) for kind in KINDS for call in chosen(sweep.counts(scenario)[kind], wanted)]
            with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
                told = pool.map(lambda item: sweep.complaint(scenario, *item, good), calls)
                for (kind, call), complaint in zip(calls, told):
                    tried += 1
                    if complaint:
                        failures += 1
                        print(f"{scenario}, {kind} {call}: {complaint}", flush=True)
            print(f"{scenario}: {len(calls)} calls failed once", flush=True)
    print(f"{tried} calls failed once, {failures} broke the promise")
    return 1 if failures or not tried else 0


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2], int(sys.argv[3]) if len(sys.argv) > 3 else 0, sys.argv[4:] or SCENARIOS))
