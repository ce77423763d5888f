#!/usr/bin/env python3
"""A slave whose tissue is a spring with a damper takes part in lock-step beside Thimble's own programs (docs/lock-step.md).
In lock-step the conductor looks for silent peers, so this slave does not."""
import argparse
import math
import socket
import struct
import sys
import tomllib

from messages import BEEP, COMMAND, FEEDBACK, FIXTURE, HEARTBEAT, ORDER, PROBE, REPLY, SLAVE_SIM, TRIAL_END, TRIAL_START, pack, unpack

SURFACE_m, STIFFNESS_N_per_m, DAMPING_Ns_per_m, FIXTURE_N_per_m = 0.020, 1.5, 2.0, 3000.0
LOCK_STEP, VERSION, BEGIN, END, READY, ANSWER = struct.Struct('<HHIqQ36H'), 2, 1, 3, 4, 5
# Ports, counted from the base port (docs/machines.md): where this program listens, and where its peers do.
CONTROL, NEEDLE, STOP = 7, 14, 29
SESSION, RECORD, DISPLAY, NETEM = 1, 5, 17, (19, 20, 21)


class Slave:
    """As good as new for each trial. Times are nanoseconds of the session's clock."""
    def __init__(self, base, patience_ns, instance, hold_ns):
        self.base, self.instance, self.hold_ns, self.numbers, self.sent = base, instance, hold_ns, [0] * 36, [0] * 36
        self.ports = {place: socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for place in (CONTROL, NEEDLE, STOP)}
        for place, port in self.ports.items():
            port.bind(('127.0.0.1', base + place))
            port.settimeout(patience_ns / 1e9)
        self.trial, self.running, self.reason, self.newest = 0, False, 0, 0
        self.fixture_m, self.touched_ns, self.beeped, self.next_heartbeat = math.inf, None, False, 0

    def take(self, place, counts):
        for _ in range(counts[place]):
            sender = 0
            while not self.base <= sender < self.base + 36:  # a stranger's datagram is none of those announced
                datagram, (_, sender) = self.ports[place].recvfrom(512)
            yield unpack(datagram)

    def send(self, now, kind, body, *places):
        for place in places:
            self.numbers[place] += 1
            datagram = pack(kind, (self.instance, now, self.numbers[place], self.trial, SLAVE_SIM), body)
            self.ports[CONTROL].sendto(datagram, ('127.0.0.1', self.base + place))
            self.sent[place] += 1

    def tick(self, now, counts):
        self.sent = [0] * 36
        list(self.take(STOP, counts))  # the session hears of a stop, too, and ends the trial
        for (_, _, _, trial, _), kind, body in self.take(CONTROL, counts):
            self.obey(now, trial, kind, body)
        for (_, sampled_ns, number, trial, _), kind, body in self.take(NEEDLE, counts):
            if self.running and kind == COMMAND and trial == self.trial and number > self.newest:
                self.follow(now, sampled_ns, number, *body)
        if now >= self.next_heartbeat:
            self.next_heartbeat = now + 100_000_000
            self.send(now, HEARTBEAT, (0, 0, 0, 0, 0, 0, 0, self.running, self.reason), SESSION)
        return self.next_heartbeat

    def obey(self, now, trial, kind, body):
        if kind == PROBE:
            self.send(now, REPLY, (body[0], now), SESSION)
        elif kind == ORDER and body[7] in (TRIAL_START, FIXTURE):
            self.trial, self.running, self.fixture_m, self.next_heartbeat = trial, True, body[1] if body[9] else math.inf, now
        elif kind == ORDER and body[7] == TRIAL_END:
            self.running, self.reason, self.next_heartbeat = False, body[10], now

    def follow(self, now, sampled_ns, number, needle_m, velocity_m_per_s, smooth_m):
        depth_m, beyond_m = max(0.0, smooth_m - SURFACE_m), max(0.0, needle_m - self.fixture_m)
        push_N = STIFFNESS_N_per_m * depth_m + DAMPING_Ns_per_m * velocity_m_per_s
        tissue_N, fixture_N = -max(0.0, push_N) if depth_m > 0 else 0.0, -FIXTURE_N_per_m * beyond_m
        self.newest, self.touched_ns = number, (self.touched_ns or sampled_ns) if beyond_m > 0 else None
        contact_ns = sampled_ns - (self.touched_ns or sampled_ns)
        self.send(now, FEEDBACK, (needle_m, SURFACE_m, 0, needle_m - beyond_m, tissue_N, fixture_N, tissue_N + fixture_N, contact_ns / 1e9,
                                  sampled_ns, 0, number, 2 * (depth_m > 0), self.fixture_m < math.inf, False), *NETEM, RECORD, DISPLAY)
        if contact_ns >= self.hold_ns and not self.beeped:
            self.beeped = True
            self.send(now, ORDER, (0, 0, 0, 0, b'', 0, 0, BEEP, 0, False, 0), DISPLAY)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for option in ('--base-port', '--report', '--log', '--die-with-parent', 'session'):
        parser.add_argument(option)
    parser.add_argument('--lock-step', action='store_true', required=True)
    options = parser.parse_args()
    with open(options.session, 'rb') as file:
        hold_ns = round(tomllib.load(file)['trial']['contact_hold_s'] * 1e9)
    conductor, slave = socket.socket(fileno=0), None
    while message := conductor.recv(LOCK_STEP.size):
        version, kind, _, time_ns, instance, *counts = LOCK_STEP.unpack(message)
        if version != VERSION or kind == END:
            sys.exit(0 if kind == END else f'the conductor speaks version {version}, not {VERSION}')
        for port in slave.ports.values() if slave and kind == BEGIN else ():
            port.close()
        slave = Slave(int(options.base_port), time_ns, instance, hold_ns) if kind == BEGIN else slave
        next_ns = 0 if kind == BEGIN else slave.tick(time_ns, counts)
        conductor.send(LOCK_STEP.pack(VERSION, READY if kind == BEGIN else ANSWER, 0, next_ns, 0, *slave.sent))


if __name__ == '__main__':
    main()
