// UDP datagrams out of classic pcap files, as tcpdump -w writes them: both byte orders, microseconds and nanoseconds,
// Ethernet (with VLAN tags), Linux cooked (SLL, SLL2), raw IP and loopback, IPv4. Read by hand: the format is a
// header of 24 bytes and one of 16 per packet (pcap-savefile(5)), less than what a library would add.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace thimble {

struct CapturedDatagram {
    std::int64_t stamp_ns = 0;  // since 1970, by the clock of the machine that captured
    std::uint16_t from_port = 0, to_port = 0;
    std::uint32_t payload_bytes = 0;  // as sent
    std::uint64_t payload_hash = 0;   // of what was captured of it
    bool cut = false;                 // the capture holds less than was sent (tcpdump -s)
};

struct Capture {
    std::vector<CapturedDatagram> datagrams;
    std::size_t others = 0;     // packets that are no IPv4 UDP
    std::size_t fragments = 0;  // IP fragments, left out
    bool cut_at_end = false;    // the last packet is not all there: the capture was killed
};

// Throws Error (data) naming file and byte.
Capture parse_capture(std::string_view bytes, std::string_view name);

}  // namespace thimble
