"""A node of a lock-step session in Python: Thimble's messages, and the conductor's protocol (docs/clocks.md, docs/protocol.md).
Needs no packages. The Python package has this file as thimble.lock_step."""
import argparse
import socket
import struct
import sys
import tomllib

# A message's kind is its field in Packet. The header is field 0. Of a command, the first three numbers are read.
COMMAND, FEEDBACK, ORDER, HEARTBEAT, PROBE, REPLY, WAVE = 1, 2, 4, 5, 6, 7, 14
HEADER = struct.Struct('<QqIIB7x')
FIELDS = {COMMAND: '<3d', FEEDBACK: '<8dqqIB??x', ORDER: '<Q3d16sIIBB?B4x', HEARTBEAT: '<QQ5dBB6x', PROBE: '<q', REPLY: '<qq'}
SLAVE_SIM = 2  # role of a sender
TRIAL_START, BEEP, FIXTURE, TRIAL_END = 0, 1, 2, 3  # kinds of orders
# Ports, counted from the base port (docs/protocol.md): where slave_sim listens, and where its peers do.
CONTROL, NEEDLE, STOP = 7, 14, 29
SESSION, RECORD, DISPLAY, NETEM = 1, 5, 17, (19, 20, 21)
LOCK_STEP, VERSION, BEGIN, END, READY, ANSWER = struct.Struct('<HHIqQ36H'), 2, 1, 3, 4, 5


def unpack(datagram):
    """Header, kind, and fields. A list of 16-bit places in front of the table says where each struct stands; 0: it is absent."""
    table, = struct.unpack_from('<I', datagram)
    list_at = table - struct.unpack_from('<i', datagram, table)[0]
    size, = struct.unpack_from('<H', datagram, list_at)
    places = struct.unpack_from(f'<{size // 2 - 2}H', datagram, list_at + 4)
    kind = max(field for field, place in enumerate(places) if place)
    body = struct.unpack_from(FIELDS[kind], datagram, table + places[kind]) if kind in FIELDS else ()
    return HEADER.unpack_from(datagram, table + places[0]), kind, body


def pack(kind, header, body):
    structs = HEADER.pack(*header) + struct.pack(FIELDS[kind], *body)
    places = struct.pack(f'<{kind + 3}H', 2 * kind + 6, 4 + len(structs), 4, *[0] * (kind - 1), 4 + HEADER.size)
    table = 12 + -(-len(places) // 8) * 8  # four bytes behind it the structs begin, at a multiple of eight
    return struct.pack('<I4s', table, b'THM1') + places.ljust(table - 8, b'\0') + struct.pack('<i', table - 8) + structs


class Slave:
    """In the place of thimble-slave-sim: a subclass has follow(), and started() where it needs it. run() makes a new one for each
    trial. session is the session file's dictionary. Times are nanoseconds of the session's clock."""
    def __init__(self, base, patience_ns, instance, session):
        self.base, self.instance, self.session, self.numbers, self.sent = base, instance, session, [0] * 36, [0] * 36
        self.ports = {place: socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for place in (CONTROL, NEEDLE, STOP)}
        for place, port in self.ports.items():
            port.bind(('127.0.0.1', base + place))
            port.settimeout(patience_ns / 1e9)
        self.trial, self.running, self.reason, self.newest, self.next_heartbeat = 0, False, 0, 0, 0

    def started(self, fixture_m):
        """The trial's beginning, and each change of its fixture: where it is, metres; None: there is none."""

    def follow(self, now, sampled_ns, number, needle_m, velocity_m_per_s, smooth_m):
        """A command, which feedback() answers."""
        raise NotImplementedError

    def feedback(self, now, *body):
        """Sends an answer to handle, fingertip, screen and record. body: the fields of ForceFeedback in their order."""
        self.send(now, FEEDBACK, body, *NETEM, RECORD, DISPLAY)

    def beep(self, now):
        self.send(now, ORDER, (0, 0, 0, 0, b'', 0, 0, BEEP, 0, False, 0), DISPLAY)

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
            if kind == WAVE:
                sys.exit('lock_step.py reads no waves: choose a [control] compensator without an end at the slave')
            if self.running and kind == COMMAND and trial == self.trial and number > self.newest:
                self.newest = number
                self.follow(now, sampled_ns, number, *body)
        if now >= self.next_heartbeat:
            self.next_heartbeat = now + 100_000_000
            self.send(now, HEARTBEAT, (0, 0, 0, 0, 0, 0, 0, self.running, self.reason), SESSION)
        return self.next_heartbeat

    def obey(self, now, trial, kind, body):
        if kind == PROBE:
            self.send(now, REPLY, (body[0], now), SESSION)
        elif kind == ORDER and body[7] in (TRIAL_START, FIXTURE):
            self.trial, self.running, self.next_heartbeat = trial, True, now
            self.started(body[1] if body[9] else None)
        elif kind == ORDER and body[7] == TRIAL_END:
            self.running, self.reason, self.next_heartbeat = False, body[10], now


def run(make):
    """The program: make is a subclass of Slave. Its words are those of Thimble's own node; returns when the conductor ends it."""
    parser = argparse.ArgumentParser(description=make.__doc__)
    for option in ('--base-port', '--report', '--log', '--die-with-parent', 'session'):
        parser.add_argument(option)
    parser.add_argument('--lock-step', action='store_true', required=True)
    options = parser.parse_args()
    with open(options.session, 'rb') as file:
        session = tomllib.load(file)
    conductor, node = socket.socket(fileno=0), None
    while message := conductor.recv(LOCK_STEP.size):
        version, kind, _, time_ns, instance, *counts = LOCK_STEP.unpack(message)
        if version != VERSION or kind == END:
            sys.exit(0 if kind == END else f'the conductor speaks version {version}, not {VERSION}')
        for port in node.ports.values() if node and kind == BEGIN else ():
            port.close()
        node = make(int(options.base_port), time_ns, instance, session) if kind == BEGIN else node
        next_ns = 0 if kind == BEGIN else node.tick(time_ns, counts)
        conductor.send(LOCK_STEP.pack(VERSION, READY if kind == BEGIN else ANSWER, 0, next_ns, 0, *node.sent))
