"""How much of a log is lost when its program is killed.

usage: log_kills.py PROGRAMS KILLS

Kills a thimble-slave-sim that logs every message, KILLS times, at random instants of a trial, and says how long before the kill
the last message in its log was written down: the figure of docs/log.md. PROGRAMS: build/release/bin. UDP ports from 29300 on.
"""

import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time

SESSION = """[session]
modalities = ["HF"]
delays_s = [0.0]
[trial]
contact_hold_s = 40
[network]
base_port = 29300
[log]
messages = "all"
"""


def child_named(parent, name):
    words = subprocess.run(["pgrep", "-P", str(parent), "-f", name], capture_output=True, text=True).stdout
    return int(words.split()[0])


def kill_once(programs, folder):
    session = os.path.join(folder, "session.toml")
    with open(session, "w") as file:
        file.write(SESSION)
    out = os.path.join(folder, "out")
    run = subprocess.Popen([programs + "/thimble", "run", session, "--out", out], stdout=subprocess.DEVNULL,
                           stderr=subprocess.DEVNULL)
    log = out + "/nodes/thimble-slave-sim_0ms.mcap"
    while not (os.path.exists(log) and os.path.getsize(log) > 300000):
        if run.poll() is not None:
            sys.exit("the run ended by itself")
        time.sleep(0.02)
    victim = child_named(run.pid, "thimble-slave-sim")
    time.sleep(random.random() / 10)
    killed_ns = time.clock_gettime_ns(time.CLOCK_MONOTONIC)
    os.kill(victim, signal.SIGKILL)
    run.wait()
    lines = subprocess.run([programs + "/thimble", "log", "export", log, "--json", "-"], capture_output=True, text=True,
                           check=True).stdout.splitlines()
    return (killed_ns - json.loads(lines[-1])["log_time_ns"]) / 1e6


def main():
    lost_ms = []
    for _ in range(int(sys.argv[2])):
        with tempfile.TemporaryDirectory() as folder:
            lost_ms.append(kill_once(sys.argv[1], folder))
    lost_ms.sort()
    print(f"{len(lost_ms)} kills: {lost_ms[0]:.1f} to {lost_ms[-1]:.1f} ms lost, median {lost_ms[len(lost_ms) // 2]:.1f} ms")


main()
