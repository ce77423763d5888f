#include "thimble/link_test/probe_packet.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>

namespace thimble {
namespace {

constexpr std::array kMagic{'T', 'H', 'L', 'T'};
constexpr std::uint8_t kProbeVersion = 1;
constexpr std::int64_t kMostStamp_ns = std::int64_t{1} << 62;

struct WireProbe {
    std::array<char, 4> magic = kMagic;
    std::uint8_t version = kProbeVersion, kind = 0;
    std::uint16_t port = 0;
    std::uint64_t nonce = 0;
    std::uint32_t sequence = 0, far_received = 0, far_duplicates = 0, far_reordered = 0;
    std::array<std::int64_t, 3> stamps_ns{};  // probe sent, probe arrived, echo sent
    std::uint32_t far_sent = 0;
    std::uint16_t bytes = 0, zero = 0;
};
static_assert(sizeof(WireProbe) == kProbeHeaderBytes && std::endian::native == std::endian::little,
              "copied as it stands");

bool is_one(const WireProbe& wire, std::size_t bytes) {
    const bool known = wire.kind >= static_cast<std::uint8_t>(ProbeKind::kHello) &&
                       wire.kind <= static_cast<std::uint8_t>(ProbeKind::kCounts);
    const bool timed = std::all_of(wire.stamps_ns.begin(), wire.stamps_ns.end(),
                                   [](std::int64_t ns) { return ns >= 0 && ns <= kMostStamp_ns; });
    return wire.magic == kMagic && wire.version == kProbeVersion && known && timed && wire.bytes == bytes &&
           wire.zero == 0;
}

}  // namespace

void write_probe(const ProbePacket& p, std::span<std::uint8_t> room) {
    assert(room.size() >= kProbeHeaderBytes && room.size() <= kLargestProbeBytes);
    WireProbe wire;
    wire.kind = static_cast<std::uint8_t>(p.kind);
    wire.port = p.port;
    wire.nonce = p.nonce;
    wire.sequence = p.sequence;
    wire.far_received = p.far_received;
    wire.far_duplicates = p.far_duplicates;
    wire.far_reordered = p.far_reordered;
    wire.stamps_ns = {to_nanoseconds(p.probe_sent), to_nanoseconds(p.probe_arrived),
                      to_nanoseconds(p.echo_sent)};
    wire.far_sent = p.far_sent;
    wire.bytes = static_cast<std::uint16_t>(room.size());
    std::memcpy(room.data(), &wire, sizeof wire);
    std::fill(room.begin() + kProbeHeaderBytes, room.end(), std::uint8_t{0});
}

std::optional<ProbePacket> read_probe(Bytes datagram) {
    if (datagram.size() < kProbeHeaderBytes || datagram.size() > kLargestProbeBytes) return std::nullopt;
    WireProbe wire;
    std::memcpy(&wire, datagram.data(), sizeof wire);
    if (!is_one(wire, datagram.size())) return std::nullopt;
    return ProbePacket{static_cast<ProbeKind>(wire.kind),
                       wire.port,
                       wire.nonce,
                       wire.sequence,
                       wire.far_received,
                       wire.far_duplicates,
                       wire.far_reordered,
                       wire.far_sent,
                       from_nanoseconds(wire.stamps_ns[0]),
                       from_nanoseconds(wire.stamps_ns[1]),
                       from_nanoseconds(wire.stamps_ns[2])};
}

}  // namespace thimble
