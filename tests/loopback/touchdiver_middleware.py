"""touchdiver_middleware.py PORT [--close-when-pressed]: WEART's middleware with a TouchDIVER on each hand, for one client.

It knows the messages from WEART's public SDKs, not from Thimble. It sends tracking as the real one does, and tells what it has got:
"pressed" and "slack" at once, the strongest forces at the end. A message that it does not know ends it with code 1.
"""

import json
import re
import select
import socket
import sys
import time

FORCE = re.compile(r"force:([01]\.\d{6}):0\.000000:0\.000000:(LEFT|RIGHT):(THUMB|INDEX|MIDDLE)")
STOP_FORCE = re.compile(r"stopForce:(LEFT|RIGHT):(THUMB|INDEX|MIDDLE)")


class Middleware:
    def __init__(self, close_when_pressed):
        self.close_when_pressed = close_when_pressed
        self.status = "IDLE"
        self.forces = {}
        self.strongest = {}
        self.stopped = False

    def answer(self):
        devices = [{"macAddress": f"00:1A:{i}", "handSide": side} for i, side in enumerate(("LEFT", "RIGHT"))]
        data = {"status": self.status, "version": "1.2.3", "statusCode": 0, "errorDesc": "", "actuationsEnabled": True,
                "connectedDevices": devices}
        return json.dumps({"type": "MW_STATUS", "ts": int(time.time() * 1000), "data": data})

    def take(self, message):
        """What it answers. False: it closes the connection."""
        if message.startswith("{"):
            return self.answer() if json.loads(message)["type"] == "MW_GET_STATUS" else None
        if message == "StartFromClient":
            self.status = "RUNNING"
            return self.answer()
        if message == "StopFromClient":
            self.status, self.stopped = "IDLE", True
            return self.answer()
        if match := FORCE.fullmatch(message):
            where = match[2], match[3]
            pressed = any(self.forces.values())
            self.forces[where] = float(match[1])
            if any(self.forces.values()) != pressed:
                print("slack" if pressed else "pressed", flush=True)
            self.strongest[where] = max(self.strongest.get(where, 0), float(match[1]))
            return not (self.close_when_pressed and self.forces[where] > 0) and None
        if STOP_FORCE.fullmatch(message):
            return None
        sys.exit(f"unknown message: {message!r}")

    def serve(self, client):
        unfinished = ""
        while True:
            if select.select([client], [], [], 0.01)[0]:
                came = client.recv(4096).decode()
                if not came:
                    return
                *messages, unfinished = (unfinished + came).split("~")
                for message in messages:
                    answer = self.take(message)
                    if answer is False:
                        return
                    if answer:
                        client.sendall((answer + "~").encode())
            if self.status == "RUNNING":
                client.sendall(b"Tracking:TrackType1:0:0:112:0:0:0:112:0~")


def main():
    middleware = Middleware("--close-when-pressed" in sys.argv)
    with socket.create_server(("127.0.0.1", int(sys.argv[1]))) as server:
        print("listening", flush=True)
        client, _ = server.accept()
    with client:
        try:
            middleware.serve(client)
        except ConnectionError:
            pass
    for (side, thimble), share in sorted(middleware.strongest.items()):
        print(f"{side} {thimble} {share:.3f}")
    print("pressed at the end" if any(middleware.forces.values()) else "slack at the end")
    print("stopped" if middleware.stopped else "not stopped")


main()
