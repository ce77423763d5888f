#!/usr/bin/env python3
"""lsl.py [PORT]: streams of the Lab Streaming Layer from what `thimble run --plotjuggler PORT` sends (9870).

Needs pylsl with its liblsl. Each delay that runs has three streams: events, forces (N) and positions (m).
"""

import json
import socket
import sys
import time

import pylsl

CHANNELS = {
    "Force": ("force_total_N", "force_tissue_N", "force_fixture_N", "force_hand_N"),
    "Position": ("position_needle_m", "position_surface_m", "position_fixture_m"),
}
EVENTS = ("trial", "modality", "running", "tissue_phase", "beeped", "needle_held")


class Condition:
    def __init__(self, name):
        self.streams, self.before = {}, None
        for kind, channels in {**CHANNELS, "Markers": ("event",)}.items():
            text = kind == "Markers"
            names = ["Thimble", *name.split(), kind]
            info = pylsl.StreamInfo(" ".join(names), kind, len(channels), pylsl.IRREGULAR_RATE,
                                    "string" if text else "double64", "-".join([socket.gethostname(), *names]))
            described = info.desc().append_child("channels")
            for channel in channels:
                one = described.append_child("channel").append_child_value("label", channel)
                one.append_child_value("unit", channel.rsplit("_", 1)[-1] if not text else "")
            self.streams[kind] = pylsl.StreamOutlet(info)

    def push(self, values, stamp):
        for kind, channels in CHANNELS.items():
            self.streams[kind].push_sample([float(values.get(channel, "nan")) for channel in channels], stamp)
        event = {key: values[key] for key in EVENTS if key in values}
        if event != self.before:
            self.streams["Markers"].push_sample([json.dumps(event)], stamp)
        self.before = event


def main():
    conditions = {}
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener:
        listener.bind(("127.0.0.1", int(sys.argv[1]) if len(sys.argv) > 1 else 9870))
        while True:
            one = json.loads(listener.recv(65536))
            stamp = pylsl.local_clock() - (time.time() - one["timestamp"])  # when it was, not when it came
            values = one["thimble"]
            name = next((key for key, value in values.items() if isinstance(value, dict)), "")
            if name not in conditions:
                conditions[name] = Condition(name)
            conditions[name].push(values[name] if name else values, stamp)


if __name__ == "__main__":
    main()
