"""Haply's Inverse Service as its public pages describe it, with one or more Inverse3 that nobody built.

usage: mock_haply.py FOLDER [KEY=VALUE]...

It listens at a free port of 127.0.0.1 and writes the number to FOLDER/port, and what a client commands to FOLDER/log. When it read no
message for 0.08 s, because a client or this program stood still, FOLDER/pauses says for how long. Standard library only: the test shares
no code with the driver.

  devices=ID,ID     identifiers in its list (default 049D)
  z=METRES          the cursor's height; after FOLDER/go exists the hand goes down by press=METRES within 1 s, and after FOLDER/back
                    exists it comes up again within 1 s
  calibrated=0      says that the device is not calibrated, until FOLDER/calibrated exists
  speaks=http       answers the handshake with 404; speaks=nothing never answers it
  fault=MODE        once FOLDER/fault exists: slow (10 ms for each answer), silent, close, garbage, huge, nan, far, other (device), deep,
                    drop (one answer), late (five old answers, 2 mm higher, before each)
"""

import base64
import hashlib
import json
import math
import os
import socket
import struct
import sys
import time

FOLDER = sys.argv[1]
KEYS = dict(word.split("=", 1) for word in sys.argv[2:])
GUID = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
WAY_S = 1.0
PAUSE_S = 0.08  # a service is given up after 0.2 s, of which its client may have stood still for half


def say(line, name="log"):
    with open(os.path.join(FOLDER, name), "a", encoding="utf-8") as log:
        log.write(line + "\n")


def there(name):
    return os.path.exists(os.path.join(FOLDER, name))


class Way:
    """0 to 1 within WAY_S after a file exists."""

    def __init__(self, name):
        self.name, self.began = name, None

    def share(self):
        if self.began is None and there(self.name):
            self.began = time.monotonic()
        phase = 0 if self.began is None else min((time.monotonic() - self.began) / WAY_S, 1)
        return (1 - math.cos(math.pi * phase)) / 2


class Hand:
    def __init__(self):
        self.goes, self.returns = Way("go"), Way("back")

    def height_m(self):
        press_m = float(KEYS.get("press", "0"))
        return float(KEYS.get("z", "0.15")) - press_m * (self.goes.share() - self.returns.share())


def frame(opcode, payload):
    head = bytes([0x80 | opcode])
    if len(payload) < 126:
        return head + bytes([len(payload)]) + payload
    if len(payload) < 1 << 16:
        return head + b"\x7e" + struct.pack(">H", len(payload)) + payload
    return head + b"\x7f" + struct.pack(">Q", len(payload)) + payload


class Client:
    def __init__(self, connection):
        self.connection = connection
        self.stream = connection.makefile("rb")
        self.last, self.hand, self.dropped = "", Hand(), False
        self.read_at = time.monotonic()

    def shake_hands(self):
        lines = iter(lambda: self.stream.readline().strip(), b"")
        key = [line.split(b":", 1)[1].strip() for line in lines if line.lower().startswith(b"sec-websocket-key:")][0]
        if KEYS.get("speaks") == "http":
            self.connection.sendall(b"HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n")
            return False
        accept = base64.b64encode(hashlib.sha1(key + GUID.encode()).digest())
        self.connection.sendall(b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                                b"Sec-WebSocket-Accept: " + accept + b"\r\n\r\n")
        return True

    def receive(self):
        """The next text, or None at the end."""
        while True:
            head = self.stream.read(2)
            if len(head) < 2:
                return None
            length = head[1] & 0x7F
            if length == 126:
                length = struct.unpack(">H", self.stream.read(2))[0]
            mask = self.stream.read(4)
            payload = bytes(byte ^ mask[i % 4] for i, byte in enumerate(self.stream.read(length)))
            if head[0] & 0xF == 8:
                self.connection.sendall(frame(8, payload))
                return None
            if head[0] & 0xF == 1:
                return payload.decode()

    def state(self, identifier, higher_m):
        calibrated = KEYS.get("calibrated") != "0" or there("calibrated")
        height_m = 9.0 if self.fails("far") else self.hand.height_m() + higher_m
        return {"device_id": identifier, "status": {"calibrated": calibrated},
                "state": {"cursor_position": {"x": 0.0, "y": -0.12, "z": height_m},
                          "cursor_velocity": {"x": 0.0, "y": 0.0, "z": 0.0}}}

    def fails(self, mode):
        return KEYS.get("fault") == mode and there("fault")

    def answer(self, higher_m=0.0):
        identifiers = [name for name in KEYS.get("devices", "049D").split(",") if name]
        if self.fails("other"):
            identifiers = ["OTHER"]
        text = json.dumps({"session_id": 1, "inverse3": [self.state(name, higher_m) for name in identifiers],
                           "wireless_verse_grip": []})
        if self.fails("garbage"):
            text = text[: len(text) // 2]
        if self.fails("nan"):
            text = text.replace('"y": -0.12', '"y": NaN')
        if self.fails("deep"):
            text = "[" * 60000
        if self.fails("huge"):
            text = text[:-1] + ', "more": "' + "x" * 300000 + '"}'
        return text

    def obey(self, text):
        device = json.loads(text)["inverse3"][0]
        force = list(device["commands"]["set_cursor_force"].values())[0]
        key = list(device["commands"]["set_cursor_force"])[0]
        line = f"{key} {device['device_id']} {force['x']:.2f} {force['y']:.2f} {force['z']:.2f}"
        if line != self.last:
            say(line)
        self.last = line

    def note_pause(self):
        pause_s = time.monotonic() - self.read_at
        self.read_at += pause_s
        if pause_s > PAUSE_S:
            say(f"{pause_s:.3f}", "pauses")

    def serve(self):
        if KEYS.get("speaks") == "nothing":
            time.sleep(10)
        if not self.shake_hands():
            return
        self.connection.sendall(frame(1, self.answer().encode()))
        while (text := self.receive()) is not None:
            self.note_pause()
            self.obey(text)
            if self.fails("close"):
                return
            if self.fails("slow"):
                time.sleep(0.01)
            if self.fails("drop") and not self.dropped:
                self.dropped = True
                say("dropped")
            elif not self.fails("silent"):
                old = frame(1, self.answer(0.002).encode()) * 5 if self.fails("late") else b""
                self.connection.sendall(old + frame(1, self.answer().encode()))


def main():
    listener = socket.create_server(("127.0.0.1", 0))
    with open(os.path.join(FOLDER, "port.new"), "w", encoding="utf-8") as file:
        file.write(str(listener.getsockname()[1]))
    os.rename(os.path.join(FOLDER, "port.new"), os.path.join(FOLDER, "port"))
    while True:
        connection, _ = listener.accept()
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        try:
            Client(connection).serve()
        except (OSError, ValueError, IndexError) as error:
            say(f"error {error}")
        connection.close()
        say("closed")


main()
