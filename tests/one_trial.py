"""For proofs in Python that run the programs: a session of one trial, its ports, and the programs that a run of it has started."""

import contextlib
import os
import socket
import subprocess

SESSION = """[session]
modalities = ["HF"]
delays_s = [0.0]
[trial]
contact_hold_s = {hold_s}
"""


def one_trial(hold_s, more=""):
    """A session file. HF without delay; `more`: further tables."""
    return SESSION.format(hold_s=hold_s) + more


@contextlib.contextmanager
def port_block():
    """The first of a block of ports. A socket keeps the block by its last one, as tests/guarded_ports.hpp does."""
    for block in range(150):
        base = 10000 + (os.getpid() + block) % 150 * 128
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as guard:
            try:
                guard.bind(("127.0.0.1", base + 127))
            except OSError:
                continue
            yield base
            return


def children(parent):
    """The programs that a process has started: {pid: its command line}."""
    listed = subprocess.run(["ps", "-o", "pid=,args=", "--ppid", str(parent)], capture_output=True, text=True,
                            check=False).stdout
    return {int(line.split()[0]): line.split(maxsplit=1)[1] for line in listed.splitlines()}


def name_of(command_line):
    """Of a program, without its folder."""
    return os.path.basename(command_line.split()[0])
