#include "thimble/link_test/probe_packet.hpp"

#include <algorithm>
#include <array>
#include <cassert>

namespace thimble {
namespace {

constexpr std::array<std::uint8_t, 4> kMagic{'T', 'H', 'L', 'T'};
constexpr std::uint8_t kProbeVersion = 1;
constexpr std::int64_t kMostStamp_ns = std::int64_t{1} << 62;

class Writer {
  public:
    explicit Writer(std::span<std::uint8_t> room) : room_(room) {}
    void put(std::uint64_t value, std::size_t bytes) {
        for (std::size_t i = 0; i < bytes; ++i) room_[at_++] = static_cast<std::uint8_t>(value >> (8 * i));
    }
    void put(SessionTime time) { put(static_cast<std::uint64_t>(to_nanoseconds(time)), 8); }

  private:
    std::span<std::uint8_t> room_;
    std::size_t at_ = 0;
};

class Reader {
  public:
    explicit Reader(Bytes bytes) : bytes_(bytes) {}
    template <class Number>
    Number get() {
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < sizeof(Number); ++i) value |= std::uint64_t{bytes_[at_++]} << (8 * i);
        return static_cast<Number>(value);
    }
    SessionTime time() {
        const auto ns = get<std::int64_t>();
        if (ns < 0 || ns > kMostStamp_ns) good_ = false;
        return from_nanoseconds(ns);
    }
    bool good() const { return good_; }

  private:
    Bytes bytes_;
    std::size_t at_ = 0;
    bool good_ = true;
};

}  // namespace

void write_probe(const ProbePacket& p, std::span<std::uint8_t> room) {
    assert(room.size() >= kProbeHeaderBytes && room.size() <= kLargestProbeBytes);
    Writer out(room);
    for (const std::uint8_t letter : kMagic) out.put(letter, 1);
    out.put(kProbeVersion, 1);
    out.put(static_cast<std::uint8_t>(p.kind), 1);
    out.put(p.port, 2);
    out.put(p.nonce, 8);
    for (const std::uint32_t number : {p.sequence, p.far_received, p.far_duplicates, p.far_reordered})
        out.put(number, 4);
    for (const SessionTime time : {p.probe_sent, p.probe_arrived, p.echo_sent}) out.put(time);
    out.put(p.far_sent, 4);
    out.put(room.size(), 2);
    out.put(0, 2);
    std::fill(room.begin() + kProbeHeaderBytes, room.end(), std::uint8_t{0});
}

std::optional<ProbePacket> read_probe(Bytes datagram) {
    if (datagram.size() < kProbeHeaderBytes || datagram.size() > kLargestProbeBytes) return std::nullopt;
    if (!std::equal(kMagic.begin(), kMagic.end(), datagram.begin())) return std::nullopt;
    Reader in(datagram.subspan(kMagic.size()));
    if (in.get<std::uint8_t>() != kProbeVersion) return std::nullopt;
    ProbePacket p;
    const auto kind = in.get<std::uint8_t>();
    p.kind = static_cast<ProbeKind>(kind);
    p.port = in.get<std::uint16_t>();
    p.nonce = in.get<std::uint64_t>();
    p.sequence = in.get<std::uint32_t>();
    p.far_received = in.get<std::uint32_t>();
    p.far_duplicates = in.get<std::uint32_t>();
    p.far_reordered = in.get<std::uint32_t>();
    p.probe_sent = in.time();
    p.probe_arrived = in.time();
    p.echo_sent = in.time();
    p.far_sent = in.get<std::uint32_t>();
    const bool whole = in.get<std::uint16_t>() == datagram.size() && in.get<std::uint16_t>() == 0;
    const bool known = kind >= static_cast<std::uint8_t>(ProbeKind::kHello) &&
                       kind <= static_cast<std::uint8_t>(ProbeKind::kCounts);
    if (!whole || !known || !in.good()) return std::nullopt;
    return p;
}

}  // namespace thimble
