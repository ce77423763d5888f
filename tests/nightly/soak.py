"""A sitting of a virtual participant with the real programs, for as long as asked, over a network with jitter and loss.

usage: soak.py PROGRAMS SECONDS [BASE_PORT]

PROGRAMS: build/release/bin. Fails (exit code 1) unless every trial completes, no program's memory grows (once it is warm, by more than
4 MiB; thimble itself, which keeps a row per trial, by more than 16 MiB an hour), and the counters add up:
what a program sent, the network delivered, lost by name, or the receiver counted.
"""

import json
import os
import subprocess
import sys
import tempfile
import time

SESSION = """[session]
modalities = ["CF", "CCF", "VF"]
[network]
base_port = {port}
[protocol]
experiments = [1]
trials_per_modality = {trials}
practice_trials = 0
break_every = 0
[netem.needle]
delay_s = 0.002
jitter = "uniform"
jitter_spread_s = 0.001
loss = 0.01
[netem.force]
delay_s = 0.005
jitter = "gamma"
jitter_spread_s = 0.001
loss = 0.01
"""
MODALITIES, TRIAL_S = 3, 13  # a trial of these lasts about so long


def resident_kib(pid):
    with open(f"/proc/{pid}/status") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmRSS"))


def family(parent):
    """The run and its nodes: {pid: name}."""
    listed = subprocess.run(["ps", "-o", "pid=,comm=", "--ppid", str(parent)], capture_output=True, text=True).stdout
    nodes = {int(line.split()[0]): line.split()[1] for line in listed.splitlines() if "thimble" in line}
    return nodes | {parent: "thimble"}


def watch(run, seconds):
    """The memory of each program, KiB, once it is warm and at the end."""
    begin, first, last = time.monotonic(), {}, {}
    while run.poll() is None:
        time.sleep(1)
        for pid, name in family(run.pid).items():
            try:
                last[name] = resident_kib(pid)
            except (OSError, StopIteration):
                continue  # it has just ended
            if time.monotonic() - begin > min(60, seconds / 3):
                first.setdefault(name, last[name])
    return {name: (first[name], last[name]) for name in first}


def memory_findings(memory, seconds):
    for name, (first, last) in sorted(memory.items()):
        allowed = 4096 + (16 * 1024 * seconds / 3600 if name == "thimble" else 0)
        print(f"{name:18} {first / 1024:7.1f} MiB warm, {last / 1024:7.1f} MiB at the end")
        if last - first > allowed:
            yield f"{name} has grown by {(last - first) / 1024:.1f} MiB"


def report_of(folder, node):
    for root, _, files in os.walk(folder):
        for file in files:
            if file.startswith(f"thimble-{node}_") and file.endswith(".json"):
                with open(os.path.join(root, file)) as text:
                    return json.load(text)
    raise SystemExit(f"soak: there is no report of thimble-{node}")


def counter_findings(folder):
    reports = {node: report_of(folder, node) for node in ("netem", "master", "slave-sim", "cutaneous", "visual")}
    for node, report in reports.items():
        counted = report["accepted"] + sum(report["refused"].values())
        # The relay hands on what it does not read.
        read = report["udp"]["received"] - sum(link["pushed"] for link in report.get("links", []))
        print(f"{node:18} {report['udp']['received']} datagrams received, {counted} accepted or refused by name")
        if read != counted:
            yield f"{node} read {read} datagrams and counted {counted}"
        if report["udp"]["send_failed"]:
            yield f"{node}: {report['udp']['send_failed']} sends failed"
    links = reports["netem"]["links"]
    for number, link in enumerate(links):
        gone = sum(link[name] for name in ("lost", "outage", "queue_full", "overflowed", "oversized"))
        under_way = link["pushed"] + link["duplicated"] - link["delivered"] - gone
        print(f"link {number}             {link['pushed']} in, {link['delivered']} out, {link['lost']} lost")
        if not 0 <= under_way <= 100:  # what was in it when it was told to end
            yield f"link {number}: {under_way} packets are neither delivered nor lost by name"
    if links[0]["pushed"] != reports["master"]["samples"]:
        yield f"the master sent {reports['master']['samples']} needles, {links[0]['pushed']} reached the network"


def main():
    if len(sys.argv) not in (3, 4):
        raise SystemExit(__doc__)
    programs, seconds = sys.argv[1], float(sys.argv[2])
    port = int(sys.argv[3]) if len(sys.argv) == 4 else 29400
    with tempfile.TemporaryDirectory(prefix="thimble-soak-") as folder:
        session = os.path.join(folder, "session.toml")
        with open(session, "w") as file:
            file.write(SESSION.format(port=port, trials=max(1, round(seconds / (MODALITIES * TRIAL_S)))))
        with open(os.path.join(folder, "words"), "w+") as words:
            run = subprocess.Popen([programs + "/thimble", "run", session, "--out", folder + "/data"],
                                   stdin=subprocess.DEVNULL, stdout=words, stderr=words)
            begin = time.monotonic()
            memory = watch(run, seconds)
            took = time.monotonic() - begin
            words.seek(0)
            said = words.read()
        if run.returncode != 0:
            raise SystemExit(f"{said[-3000:]}\nsoak: thimble run ended with {run.returncode}")
        findings = []
        trials = [line for line in said.splitlines() if line.startswith("trial ")]
        bad = [line for line in trials if ": completed" not in line]
        findings += bad + ([] if trials else ["no trial was run"])
        findings += memory_findings(memory, took)
        findings += counter_findings(folder)
        print(f"{len(trials)} trials in {took:.0f} s")
        for finding in findings:
            print("soak:", finding)
        if findings:
            print(said[-3000:])
        return 1 if findings else 0


sys.exit(main())
