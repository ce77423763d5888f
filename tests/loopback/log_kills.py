"""How much of a log is lost when its program is killed.

usage: log_kills.py PROGRAMS KILLS [BASE_PORT]

Kills a program that logs every message, KILLS times, at random instants of a trial: thimble-slave-sim, thimble-master and thimble itself
in turn. Says how long before the kill the last message in its log was written down: the figure of docs/log.md. Exit code 1 if
one lost more than the 100 ms that are promised, or left a program behind. That is for a machine with room: a log is written every 40 ms,
by a thread that on a crowded machine waits for a processor as well. PROGRAMS: build/release/bin. UDP ports from 29300 on.
"""

import json
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from one_trial import children, one_trial  # noqa: E402

TABLES = """[network]
base_port = {port}
[log]
messages = "all"
"""
PROMISED_MS = 100
VICTIMS = ("thimble-slave-sim", "thimble-master", "session")  # as their logs are named; the session's program is thimble


def wait_until_gone(pids):
    """Programs that the launcher started, which it or the kernel ends with it."""
    end = time.monotonic() + 10
    while left := [pid for pid in pids if os.path.exists(f"/proc/{pid}")]:
        if time.monotonic() > end:
            sys.exit(f"log_kills: still there after 10 s: {left}")
        time.sleep(0.02)


def kill_once(programs, port, victim, folder):
    session = os.path.join(folder, "session.toml")
    with open(session, "w") as file:
        file.write(one_trial(40, TABLES.format(port=port)))
    out = os.path.join(folder, "out")
    run = subprocess.Popen([programs + "/thimble", "run", session, "--out", out], stdout=subprocess.DEVNULL,
                           stderr=subprocess.DEVNULL, env={**os.environ, "XDG_STATE_HOME": folder})
    log = f"{out}/nodes/{victim}_0ms.mcap"
    while not (os.path.exists(log) and os.path.getsize(log) > 300000):
        if run.poll() is not None:
            sys.exit("log_kills: the run ended by itself")
        time.sleep(0.02)
    nodes = children(run.pid)
    pid = run.pid if victim == "session" else next(pid for pid, words in nodes.items() if victim in words)
    time.sleep(random.random() / 10)
    killed_ns = time.clock_gettime_ns(time.CLOCK_MONOTONIC)
    os.kill(pid, signal.SIGKILL)
    run.wait()
    wait_until_gone(nodes)
    lines = subprocess.run([programs + "/thimble", "log", "export", log, "--json", "-"], capture_output=True, text=True,
                           check=True).stdout.splitlines()
    return (killed_ns - json.loads(lines[-1])["log_time_ns"]) / 1e6


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    programs, kills = sys.argv[1], int(sys.argv[2])
    port = int(sys.argv[3]) if len(sys.argv) == 4 else 29300
    lost_ms = {victim: [] for victim in VICTIMS}
    for number in range(kills):
        victim = VICTIMS[number % len(VICTIMS)]
        with tempfile.TemporaryDirectory() as folder:
            lost_ms[victim].append(kill_once(programs, port, victim, folder))
    for victim, lost in lost_ms.items():
        if lost:
            lost.sort()
            print(f"{victim}: {len(lost)} kills, {lost[0]:.1f} to {lost[-1]:.1f} ms lost, median {lost[len(lost) // 2]:.1f} ms")
    every = sorted(sum(lost_ms.values(), []))
    too_much = [lost for lost in every if lost > PROMISED_MS]
    print(f"{len(every)} kills: {every[0]:.1f} to {every[-1]:.1f} ms lost, median {every[len(every) // 2]:.1f} ms, "
          f"{len(too_much)} of them more than {PROMISED_MS} ms")
    if too_much:
        print(f"log_kills: a log lost more than the {PROMISED_MS} ms that are promised for a machine with room")
    return 1 if too_much else 0


sys.exit(main())
