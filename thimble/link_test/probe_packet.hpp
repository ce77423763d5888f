// The datagrams of a link test. Not those of a session (docs/protocol.md): a node refuses them as foreign_format, and the
// echo refuses a session's. Little-endian, 64 bytes, then zeros up to the size that is tried:
//
//     0  "THLT"        4  version 1      5  kind             6  port offset (u16)      8  nonce (u64)
//     16 sequence      20 far received   24 far duplicates   28 far reordered          (u32 each)
//     32 probe sent    40 probe arrived  48 echo sent        (i64 ns; the first on the asker's clock, others on the echo's)
//     56 far sent (u32)                  60 size of the datagram (u16)                 62 zero (u16)
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/channel.hpp"
#include "common/network_settings.hpp"
#include "common/time.hpp"

namespace thimble {

inline constexpr std::size_t kProbeHeaderBytes = 64;
inline constexpr std::size_t kLargestProbeBytes = 65507;  // of any UDP datagram over IPv4

// Each request has the answer that follows it. A hello brings the nonce that every other request must bear.
enum class ProbeKind : std::uint8_t { kHello = 1, kWelcome, kProbe, kEcho, kQuery, kCounts };

struct ProbePacket {
    ProbeKind kind = ProbeKind::kHello;
    std::uint16_t port = 0;   // offset from the base port
    std::uint64_t nonce = 0;  // hello: drawn by the asker, to tell two test runs apart
    std::uint32_t sequence = 0;
    // The echo's counts of this test at this port.
    std::uint32_t far_received = 0;  // distinct probes
    std::uint32_t far_duplicates = 0;
    std::uint32_t far_reordered = 0;  // came behind a later one
    std::uint32_t far_sent = 0;       // echoes
    SessionTime probe_sent{}, probe_arrived{}, echo_sent{};
};

// Writes a datagram that fills `room`, at least kProbeHeaderBytes.
void write_probe(const ProbePacket& packet, std::span<std::uint8_t> room);
// None if it is not exactly such a datagram.
std::optional<ProbePacket> read_probe(Bytes datagram);

// A session's traffic at each of its UDP ports: sizes as sealed, rates from docs/protocol.md.
struct PortTraffic {
    Port port = Port::kCount;
    std::size_t bytes = 0;  // of one datagram
    double rate_Hz = 0;     // while a trial runs
    bool haptic = false;    // part of the loop at the rate of the handle's samples
};

// All ports, by offset.
std::array<PortTraffic, kPortCount> session_traffic();
// Those that the programs on `host` listen at; all if no role of [network] is there.
std::vector<Port> ports_on(const NetworkSettings& network, const std::string& host);
// "slave_sim_needle", as in the list of ports of docs/protocol.md.
const char* to_string(Port port);

}  // namespace thimble
