"""Wireshark's own program reads Thimble's messages by the dissector that `thimble log dissector` prints."""
import os
import pathlib
import shutil
import struct
import subprocess

import pytest

from thimble.lock_step import FEEDBACK, HEARTBEAT, ORDER, PROBE, SLAVE_SIM, pack

BIN = pathlib.Path(os.environ["THIMBLE_BIN"])
MESSAGES = [(FEEDBACK, (0.125, 0.02, -0.5, 0.1, -1.5, -2.5, -4.0, 3.25, 123456789012, 5, 42, 2, True, False)),
            (ORDER, (9, 0.1, 0.2, 0.05, b"leo".ljust(16, b"\0"), 3, 1, 1, 2, True, 0)), (HEARTBEAT, (1, 2, 0, 0, 0, 0, 0, 1, 7)),
            (PROBE, (-9,))]


def capture(path, datagrams, port):
    """pcap of Ethernet frames: IPv4, UDP, without checksums."""
    with open(path, "wb") as file:
        file.write(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 1))
        for datagram in datagrams:
            udp = struct.pack(">HHHH", 40000, port, 8 + len(datagram), 0) + datagram
            ip = struct.pack(">BBHHHBBH4s4s", 0x45, 0, 20 + len(udp), 0, 0, 64, 17, 0, bytes([127, 0, 0, 1]), bytes([127, 0, 0, 1]))
            frame = bytes(12) + b"\x08\x00" + ip + udp
            file.write(struct.pack("<IIII", 1, 0, len(frame), len(frame)) + frame)


@pytest.fixture
def shown(tmp_path):
    tshark = os.environ.get("TSHARK", shutil.which("tshark"))
    if not tshark:
        pytest.skip("there is no tshark (package tshark)")
    script = tmp_path / "thimble.lua"
    script.write_text(subprocess.run([BIN / "thimble", "log", "dissector"], check=True, capture_output=True, text=True).stdout)

    def show(datagrams, *fields):
        capture(tmp_path / "wire.pcap", datagrams, 27005)
        words = [word for field in fields for word in ("-e", field)]
        told = subprocess.run([tshark, "-r", tmp_path / "wire.pcap", "-X", f"lua_script:{script}", "-T", "fields", *words],
                              capture_output=True, text=True, env={**os.environ, "HOME": str(tmp_path)})
        assert told.returncode == 0 and "Lua" not in told.stderr, told.stderr
        return [line.split("\t") for line in told.stdout.splitlines()]

    return show


def test_every_field_is_what_was_sent(shown):
    datagrams = [pack(kind, (77, -5, 6, 4, SLAVE_SIM), body) for kind, body in MESSAGES]
    force, order, beat, probe = shown(datagrams, "_ws.col.Info", "thimble.header.sequence", "thimble.force_feedback.force_total_N",
                                      "thimble.force_feedback.echo_time_ns", "thimble.force_feedback.phase", "thimble.session_control.network",
                                      "thimble.session_control.fixture_position_m", "thimble.heartbeat.reason", "thimble.clock_probe.send_time_ns")
    assert force[:5] == ["force_feedback /slave_sim/record", "6", "-4", "123456789012", "2"]
    assert order[0].startswith("session_control") and order[5:7] == ["leo", "0.1"]
    assert beat[0].startswith("heartbeat") and beat[7] == "7" and probe[0].startswith("clock_probe")


def test_bytes_that_are_cut_or_wrong_are_no_error_of_the_script(shown):
    whole = pack(*[FEEDBACK, (77, -5, 6, 4, SLAVE_SIM), MESSAGES[0][1]])
    wrong = [whole[:length] for length in range(0, len(whole), 7)] + [whole[:at] + b"\xff" + whole[at + 1:] for at in range(0, 40)]
    assert len(shown(wrong, "_ws.col.Protocol")) == len(wrong)
