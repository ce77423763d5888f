"""The part of pylsl that examples/lsl/lsl.py uses: it prints each stream and each sample as a line of JSON."""

import json
import time

IRREGULAR_RATE = 0.0


def say(*words):
    print(json.dumps(words), flush=True)


def local_clock():
    return time.time()  # the date's clock, so that a stamp is the datagram's own


class Element:
    def append_child(self, _name):
        return self

    def append_child_value(self, _name, _value):
        return self


class StreamInfo:
    def __init__(self, name, kind, channels, rate, channel_format, source):
        self.name, self.channels, self.text = name, channels, channel_format == "string"
        say("stream", name, kind, channels, rate, channel_format, source)

    def desc(self):
        return Element()


class StreamOutlet:
    def __init__(self, info):
        self.info = info

    def push_sample(self, sample, stamp):
        assert len(sample) == self.info.channels and all(isinstance(one, str if self.info.text else float) for one in sample)
        say("sample", self.info.name, sample, round(stamp))
