"""What a program that knows nothing of Thimble hears at PlotJuggler's port.

usage: hear_plotjuggler.py PORT_FILE SECONDS

Chooses a UDP port, writes it to PORT_FILE, listens until the needle has moved (or so long), and prints: the keys, how many
datagrams a second, whether times went up.
"""

import json
import os
import socket
import sys
import time

heard = []
with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener:
    listener.bind(("127.0.0.1", 0))
    listener.settimeout(float(sys.argv[2]))
    with open(sys.argv[1] + ".new", "w") as file:
        file.write(str(listener.getsockname()[1]))
    os.rename(sys.argv[1] + ".new", sys.argv[1])
    end = time.monotonic() + float(sys.argv[2])
    while time.monotonic() < end:
        heard.append(json.loads(listener.recv(65536)))
        needles = [one["thimble"]["position_needle_m"] for one in heard]
        if len(heard) > 20 and max(needles) - min(needles) > 0.01:
            break

times = [one["timestamp"] for one in heard]
print(json.dumps({
    "keys": sorted(heard[-1]["thimble"]),
    "moved_m": max(needles) - min(needles),
    "per_second": len(heard) / (times[-1] - times[0]),
    "times_go_up": all(a < b for a, b in zip(times, times[1:])),
    "behind_s": time.time() - times[-1],
    "last": heard[-1]["thimble"],
}))
