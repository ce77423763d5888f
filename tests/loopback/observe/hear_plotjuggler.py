"""What a program that knows nothing of Thimble hears at PlotJuggler's port.

usage: hear_plotjuggler.py PORT_FILE SECONDS [CONDITIONS]

Chooses a UDP port, writes it to PORT_FILE, listens until the needle has moved (of several conditions: until each has been heard often; or so
long), and prints of each condition: the keys, how many datagrams a second, whether times went up. A condition that has no name is "".
"""

import json
import os
import socket
import sys
import time

lanes_wanted = int(sys.argv[3]) if len(sys.argv) > 3 else 1
heard = {}  # by condition: time and values


def moved_m(condition):
    needles = [values["position_needle_m"] for _, values in heard[condition]]
    return max(needles) - min(needles)


def summary(condition):
    times = [stamp for stamp, _ in heard[condition]]
    return {
        "keys": sorted(heard[condition][-1][1]),
        "moved_m": moved_m(condition),
        "per_second": len(times) / (times[-1] - times[0]),
        "times_go_up": all(a < b for a, b in zip(times, times[1:])),
        "behind_s": time.time() - times[-1],
        "last": heard[condition][-1][1],
    }


with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener:
    listener.bind(("127.0.0.1", 0))
    listener.settimeout(float(sys.argv[2]))
    with open(sys.argv[1] + ".new", "w") as file:
        file.write(str(listener.getsockname()[1]))
    os.rename(sys.argv[1] + ".new", sys.argv[1])
    end = time.monotonic() + float(sys.argv[2])
    while time.monotonic() < end:
        one = json.loads(listener.recv(65536))
        values = one["thimble"]
        condition = next((key for key in values if isinstance(values[key], dict)), "")
        heard.setdefault(condition, []).append((one["timestamp"], values[condition] if condition else values))
        done = [key for key in heard if len(heard[key]) > 20 and (lanes_wanted > 1 or moved_m(key) > 0.01)]
        if len(done) == lanes_wanted:
            break

print(json.dumps({condition: summary(condition) for condition in heard}))
