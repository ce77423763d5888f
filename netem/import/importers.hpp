// Measured paths from files of other programs: irtt, ping, tcpdump. Every error is an Error (data) that names the
// file and the place in it.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "netem/formats/measured_path.hpp"

namespace thimble {

struct MeasuredPaths {
    MeasuredPath up, down;  // client to server, server to client
};

// The output of `irtt client -o FILE.json` (irtt-client(1), "JSON FORMAT"). Times are the client's sends, also for `down`
// (the server answers at once). With the server's stamps the delays are one-way, as good as the two clocks agree; a
// remark judges that. Without them each is half of the round trip. A packet lost where irtt cannot tell counts as lost
// upwards.
MeasuredPaths parse_irtt(std::string_view text, std::string_view name);

// The output of ping: iputils (also with -D, its time stamps, and -O, its "no answer yet"), busybox, BSD and macOS.
// Each delay is half of the round trip, the same for both directions: ping cannot tell them apart, and a remark says so.
// Losses are the numbers missing between the first and the last, and at the end those that the summary counts as
// sent. With time stamps (-D) a lost packet stands between its neighbours; without, `interval` stands between two
// packets (ping's -i, 1 s by itself).
MeasuredPath parse_ping(std::string_view text, std::string_view name, Duration interval);

struct CapturedDatagram {
    std::int64_t stamp_ns = 0;  // since 1970, by the clock of the machine that captured
    std::uint16_t to_port = 0;
    std::uint32_t payload_bytes = 0;  // as sent
    std::size_t payload_hash = 0;     // of what was captured of it
};

struct Capture {
    std::vector<CapturedDatagram> datagrams;
    std::size_t others = 0;     // packets that are no UDP
    std::size_t fragments = 0;  // IP fragments, left out
    bool cut_at_end = false;    // the last packet is not all there: the capture was killed
};

// The UDP datagrams, over IPv4 and IPv6, of a pcap or pcapng file, as libpcap reads it: on Ethernet (with VLAN tags), Linux cooked (SLL,
// SLL2), raw IP and loopback.
Capture parse_capture(std::string_view bytes, std::string_view name);

struct CapturePairOptions {
    // Destination ports, where a capture holds more than the one flow: a relay or an address translation between the
    // two may change them.
    std::optional<std::uint16_t> sent_port{}, received_port{};
    // Moves all delays so that the least is this one: for clocks that are not synchronised.
    std::optional<Duration> least_delay{};
};

struct CapturePair {
    MeasuredPath path;
    std::size_t sent = 0, received = 0;  // datagrams looked at
    std::size_t lost = 0;
    std::size_t duplicates = 0;  // received more often than sent
    std::size_t reordered = 0;   // received after one that was sent later (RFC 4737)
    std::size_t ambiguous = 0;   // equal payloads, not all received: which of them was lost is a guess
    std::size_t foreign = 0;     // received, but never sent
    Duration least{}, most{};    // delays as the stamps have them, before any move
};

// A path from two captures of the same traffic, near the sender and near the receiver. Datagrams are the same if payload
// and length are; equal ones are matched in their order. Refuses captures without a match, and delays below 0 if
// options.least_delay does not say what to do about them.
CapturePair match_captures(const Capture& sent, const Capture& received, const CapturePairOptions& options);

}  // namespace thimble
