"""All mutants against all test programs: which are killed by which test. What is found is kept at once, in FOLDER."""

import concurrent.futures
import hashlib
import json
import sys
import threading

from mutant_list import ListError
from test_runs import confirmed, reached_numbers, stop_all

SLACK_S = 30  # for a machine that is busy; a mutant that needs longer than this and four times the usual hangs


def digest(*contents):
    return hashlib.sha256(b"\0".join(contents)).hexdigest()[:16]


class Campaign:
    def __init__(self, folder, binaries, jobs):
        self.folder, self.binaries, self.jobs = folder, binaries, jobs
        self.baseline_file, self.results_file = folder / "baseline.json", folder / "results.jsonl"
        self.baseline, self.results, self.lock = {}, {}, threading.Lock()
        if self.baseline_file.exists():
            self.baseline = json.loads(self.baseline_file.read_text())
        if self.results_file.exists():
            for line in self.results_file.read_text().splitlines():
                found = json.loads(line)
                self.results[found["number"]] = found

    def _in_parallel(self, work, items):
        pool = concurrent.futures.ThreadPoolExecutor(self.jobs)
        try:
            for done, future in enumerate(concurrent.futures.as_completed([pool.submit(work, item) for item in items]), 1):
                print(f"[{done}/{len(items)}] {future.result()}", file=sys.stderr, flush=True)
        except BaseException:
            stop_all()
            raise
        finally:
            pool.shutdown(cancel_futures=True)

    def _measure(self, program):
        path = self.binaries / program
        stamp = digest(path.read_bytes())
        if self.baseline.get(program, {}).get("digest") != stamp:
            run, numbers = reached_numbers(path, 3600)
            if run.failed:
                raise ListError(f"{program} fails without a mutant, at {run.failed}:\n{run.output[-3000:]}")
            with self.lock:
                self.baseline[program] = {"digest": stamp, "seconds": run.seconds, "reached": numbers}
                self.baseline_file.write_text(json.dumps(self.baseline))
        return f"{program}: {self.baseline[program]['seconds']:.1f} s, reaches {len(self.baseline[program]['reached'])} mutants"

    def measure(self, programs):
        """Each program once without a mutant: it has to pass."""
        self._in_parallel(self._measure, programs)

    def order(self, mutant, own, others):
        """The programs that reach the mutant: its room's first, then the others, the quick ones first."""
        others = sorted(set(others) - set(own), key=lambda name: self.baseline[name]["seconds"])
        return [name for name in [*own, *others] if mutant.number in self.baseline[name]["reached"]]

    def _try(self, mutant, programs):
        """Goes on where an earlier run of the same programs ended."""
        state = {name: self.baseline[name]["digest"] for name in programs}
        before = self.results.get(mutant.number, {})
        if before.get("killer") and state.get(before["program"]) == before["digest"]:
            return f"killed    {mutant}"
        passed = {name: stamp for name, stamp in before.get("passed", {}).items() if state.get(name) == stamp}
        found = {"number": mutant.number, "passed": passed, "killer": ""}
        for name in programs:
            if name in passed:
                continue
            run = confirmed(self.binaries / name, 4 * self.baseline[name]["seconds"] + SLACK_S, {"THIMBLE_MUTANT": str(mutant.number)})
            if run.failed:
                found |= {"killer": run.failed, "program": name, "digest": state[name]}
                break
            passed[name] = state[name]
        with self.lock:
            self.results[mutant.number] = found
            with self.results_file.open("a") as file:
                file.write(json.dumps(found) + "\n")
        return f"killed    {mutant}   by {found['killer']}" if found["killer"] else f"SURVIVED  {mutant}"

    def run(self, mutants, programs_of):
        """programs_of: the programs to try for a mutant, in this order."""
        self._in_parallel(lambda mutant: self._try(mutant, programs_of(mutant)), mutants)

    def survivors(self, mutants):
        return [mutant for mutant in mutants if not self.results.get(mutant.number, {}).get("killer")]
