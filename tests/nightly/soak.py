"""A participant session of a virtual participant with the real programs, for as long as asked, over a network with jitter and loss.

usage: soak.py PROGRAMS SECONDS [BASE_PORT]

PROGRAMS: build/release/bin. Under a lab key made for it. Fails (exit code 1) unless every trial completes, no program's memory grows
(once it is warm, by more than 4 MiB; thimble itself, which keeps a row per trial, by more than 16 MiB an hour), and the counters add up,
port by port from end to end: what a program sent reached the network, which delivered it or lost it by name; what was
delivered, its receiver accepted or refused by name. What is missing at a socket is a finding that names the socket.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from one_trial import children, name_of  # noqa: E402

SESSION = """[session]
modalities = ["CF", "CCF", "VF"]
[network]
base_port = {port}
[protocol]
experiments = [3]
trials_per_modality = {trials}
practice_trials = 0
break_every = 0
[security]
mode = "lab-key"
key_file = "{key}"
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
PORTS = 60  # of a session, or a few more


def resident_kib(pid):
    with open(f"/proc/{pid}/status") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmRSS"))


def family(parent):
    """The run and its nodes: {pid: name}."""
    nodes = {pid: name_of(words) for pid, words in children(parent).items()}
    return {pid: name for pid, name in nodes.items() if "thimble" in name} | {parent: "thimble"}


def dropped_at_sockets(first_port):
    """What the kernel threw away because a socket was full: {port: datagrams}. Its last column; ports in hexadecimal."""
    with open("/proc/net/udp") as file:
        rows = [line.split() for line in file.readlines()[1:]]
    ports = [(int(row[1].split(":")[1], 16), int(row[-1])) for row in rows]
    return {port: drops for port, drops in ports if first_port <= port < first_port + PORTS and drops}


def watch(run, seconds, port, dropped):
    """The memory of each program, KiB, once it is warm and at the end. Notes in `dropped` what sockets lost."""
    begin, first, last = time.monotonic(), {}, {}
    while run.poll() is None:
        time.sleep(1)
        dropped |= dropped_at_sockets(port)
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
    for path in pathlib.Path(folder).rglob(f"thimble-{node}_*.json"):
        return json.loads(path.read_text())
    raise SystemExit(f"soak: there is no report of thimble-{node}")


LINKS = (("needle", "slave-sim"), ("force to the handle", "master"), ("force to the fingers", "cutaneous"),
         ("force to the screen", "visual"))
DROPPED = ("lost", "outage", "queue_full", "overflowed", "oversized")
REFUSED = ("forged", "replayed", "wrong_role", "no_key", "unsealed")
MOST_UNDER_WAY = 100  # of a link: what was in it, and in sockets, when the programs were told to end
WORDS_ABOUT_KEYS = 100  # handshakes, grants and receipts of a program; each handshake more is as many again


def own_words(reports):
    """What each program sent and read beside the links: heartbeats, percepts, words about keys; orders, beeps."""
    links = reports["netem"]["links"]
    pushed, delivered = [link["pushed"] for link in links], [link["delivered"] for link in links]
    sent = {node: report["udp"]["sent"] for node, report in reports.items()}
    sent["netem"] -= sum(delivered)
    sent["master"] -= pushed[0]
    sent["slave-sim"] -= sum(pushed[1:]) + 2 * pushed[1]  # with each force a record for the session and a picture for the screen
    read = {node: report["udp"]["received"] for node, report in reports.items()}
    read["netem"] -= sum(pushed)  # the relay hands on what it does not read
    for (_, receiver), packets in zip(LINKS, delivered):
        read[receiver] -= packets
    read["visual"] -= pushed[1]  # a picture does not pass the network
    return sent, read


def node_findings(node, report, relayed):
    """What a program's sockets gave it, it opened or refused; what it opened, it accepted, refused by name, or relayed."""
    security, read = report["security"], report["udp"]["received"]
    if security["mode"] != "lab-key":
        yield f"{node} ran without the lab key"
        return
    opened, refused = security["opened"], sum(security[name] for name in REFUSED)
    counted = report["accepted"] + sum(report["refused"].values()) + relayed
    print(f"{node:18} {read} datagrams read, {opened} opened, {counted} accepted or refused by name")
    about_keys = WORDS_ABOUT_KEYS * (1 + security["handshakes"])
    if not 0 <= read - opened - refused <= about_keys:
        yield f"{node} read {read} datagrams, opened {opened} and refused {refused}"
    if not 0 <= opened - counted <= about_keys:
        yield f"{node} opened {opened} datagrams and counted {counted}"
    if refused > about_keys:
        yield f"{node} refused {refused} datagrams although nobody else is on the wire: {security}"
    if report["udp"]["send_failed"]:
        yield f"{node}: {report['udp']['send_failed']} sends failed"


def link_findings(links):
    for (name, _), link in zip(LINKS, links):
        gone = sum(link[fate] for fate in DROPPED)
        under_way = link["pushed"] + link["duplicated"] - link["delivered"] - gone
        print(f"{name:21} {link['pushed']} in, {link['delivered']} out, {gone} lost by name")
        if not 0 <= under_way <= MOST_UNDER_WAY:
            yield f"{name}: {under_way} packets are neither delivered nor lost by name"


def end_to_end_findings(reports, trials):
    """Before the network and behind it. Every program has as many words with the session, beside a few per trial (beeps)."""
    sent, read = own_words(reports)
    slack = MOST_UNDER_WAY + WORDS_ABOUT_KEYS + 10 * trials
    if abs(sent["slave-sim"] - sent["netem"]) > slack:
        yield f"slave-sim sent {sent['slave-sim'] - sent['netem']} datagrams more than reached the network"
    if reports["netem"]["links"][0]["pushed"] != reports["master"]["samples"]:
        yield f"the master sent {reports['master']['samples']} needles, another number reached the network"
    percepts = {"master": sent["cutaneous"] + sent["visual"] - 2 * sent["netem"]}
    for name, receiver in LINKS:
        missing = read["netem"] + percepts.get(receiver, 0) - read[receiver]
        if abs(missing) > slack:
            yield f"{name}: {missing} datagrams were delivered to {receiver} and not received"


def counter_findings(folder, trials):
    reports = {node: report_of(folder, node) for node in ("netem", "master", "slave-sim", "cutaneous", "visual")}
    links = reports["netem"]["links"]
    for node, report in reports.items():
        yield from node_findings(node, report, sum(link["pushed"] for link in links) if node == "netem" else 0)
    yield from link_findings(links)
    yield from end_to_end_findings(reports, trials)


def main():
    if len(sys.argv) not in (3, 4):
        raise SystemExit(__doc__)
    programs, seconds = sys.argv[1], float(sys.argv[2])
    port = int(sys.argv[3]) if len(sys.argv) == 4 else 29400
    with tempfile.TemporaryDirectory(prefix="thimble-soak-") as folder:
        session = os.path.join(folder, "session.toml")
        key = os.path.join(folder, "lab.key")
        subprocess.run([programs + "/thimble", "keygen", key], stdout=subprocess.DEVNULL, check=True)
        with open(session, "w") as file:
            file.write(SESSION.format(port=port, key=key, trials=max(1, round(seconds / (MODALITIES * TRIAL_S)))))
        with open(os.path.join(folder, "words"), "w+") as words:
            run = subprocess.Popen([programs + "/thimble", "run", session, "--out", folder + "/data"],
                                   stdin=subprocess.DEVNULL, stdout=words, stderr=words)
            begin = time.monotonic()
            dropped = {}
            memory = watch(run, seconds, port, dropped)
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
        findings += counter_findings(folder, len(trials))
        findings += [f"the kernel dropped {count} datagrams at port {at}: its socket was full" for at, count in dropped.items()]
        print(f"{len(trials)} trials in {took:.0f} s")
        for finding in findings:
            print("soak:", finding)
        if findings:
            print(said[-3000:])
        return 1 if findings else 0


sys.exit(main())
