"""Runs a controller in Python for Thimble: a class with KEYS and methods, handed to serve(). docs/howto/controller.md has an example.

Thimble starts the file and writes records to its standard input, 112 bytes each: a call's number and 13 numbers. create and force are
answered by one number. All units are SI, in the hand's frame, as in thimble/controller.h. What a controller prints goes to stderr."""
import ctypes
import os
import signal
import struct
import sys
import traceback
from typing import NamedTuple

# Answers have standard output to themselves: a print() in a controller would shift them.
ANSWERS = os.fdopen(os.dup(1), 'wb', 0)
os.dup2(2, 1)

PR_SET_PDEATHSIG = 1
GREETING = 'thimble controller 1'  # Thimble refuses a description that does not begin with it
RECORD, ANSWER = struct.Struct('=Q13d'), struct.Struct('=d')
CREATE, START, NETWORK_CHANGED, SAMPLE, RECEIVE, FORGET, FORCE = range(1, 8)


class Settings(NamedTuple):
    sample_period_s: float
    position_scale: float
    force_scale: float
    force_limit_N: float


class Handle(NamedTuple):
    time_s: float
    elapsed_s: float
    position_hand_m: float
    velocity_hand_m_per_s: float
    force_hand_N: float


class Feedback(NamedTuple):
    position_hand_m: float
    force_total_hand_N: float
    force_fixture_hand_N: float
    force_tissue_hand_N: float
    age_s: float
    known: float


class Controller:
    """KEYS: {name: (default, least, most, help)}. The values are attributes of these names."""
    NAME, KEYS = '', {}

    def start(self, network_delay_s):
        """A trial begins: forget all."""

    def network_changed(self, network_delay_s):
        """There and back, from now on."""

    def sample(self, handle):
        """The handle at a sample."""

    def receive(self, feedback):
        """Each force that arrives."""

    def forget(self):
        """The feedback became unknown."""

    def force(self, newest):
        """The force at the handle in N, positive pushes the hand out."""
        return newest.force_total_hand_N


def answer(number):
    ANSWERS.write(ANSWER.pack(number))


def call(controller, kind, numbers):
    if kind == CREATE:
        controller.settings = Settings(*numbers[:4])
        for name, value in zip(controller.KEYS, numbers[4:]):
            setattr(controller, name, value)
        answer(0)
    elif kind == SAMPLE:
        controller.sample(Handle(*numbers[:5]))
    elif kind in (RECEIVE, FORCE):
        feedback = Feedback(*numbers[:6])
        if kind == FORCE:
            answer(controller.force(feedback))
        else:
            controller.receive(feedback)
    elif kind == FORGET:
        controller.forget()
    else:
        (controller.start if kind == START else controller.network_changed)(numbers[0])


def serve(kind):
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for Thimble, which then ends this program
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)  # a call that hangs ends with Thimble
    if sys.argv[1:] == ['--describe']:
        lines = [GREETING, kind.NAME or kind.__name__] + ['\t'.join(map(str, (name, *key))) for name, key in kind.KEYS.items()]
        ANSWERS.write(('\n'.join(lines) + '\n').encode())
        return
    controller = kind()
    try:
        while len(record := sys.stdin.buffer.read(RECORD.size)) == RECORD.size:
            number, *numbers = RECORD.unpack(record)
            call(controller, number, numbers)
    except Exception:  # pylint: disable=broad-except
        traceback.print_exc()
        sys.exit(1)
