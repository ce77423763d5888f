"""Thimble's messages by struct: FlatBuffers of one table that holds two structs (common/messages.fbs, docs/protocol.md)."""
import struct

# A message's kind is its field in Packet. The header is field 0. Of a command, the first three numbers are read.
COMMAND, FEEDBACK, ORDER, HEARTBEAT, PROBE, REPLY = 1, 2, 4, 5, 6, 7
HEADER = struct.Struct('<QqIIB7x')
FIELDS = {COMMAND: '<3d', FEEDBACK: '<8dqqIB??x', ORDER: '<Q3d16sIIBB?B4x', HEARTBEAT: '<QQ5dBB6x', PROBE: '<q', REPLY: '<qq'}
SLAVE_SIM = 2  # role of a sender
TRIAL_START, BEEP, FIXTURE, TRIAL_END = 0, 1, 2, 3  # kinds of orders


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
