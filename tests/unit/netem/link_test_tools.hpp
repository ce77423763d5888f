// A packet that carries its number, and what came out of a link.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include "netem/link_model.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble::test {

inline constexpr StreamKey kKey{.study = 7, .experiment = 3, .subject = 5, .trial = 2};
inline constexpr Duration kMillisecond = std::chrono::milliseconds{1};

// `size` bytes: the number in the first four, its last byte repeated in the rest.
class NumberedPacket {
  public:
    explicit NumberedPacket(std::uint32_t number, std::size_t size = 200) : size_(size) {
        bytes_.fill(static_cast<std::uint8_t>(number));
        std::memcpy(bytes_.data(), &number, sizeof number);
    }
    Bytes bytes() const { return {bytes_.data(), size_}; }

  private:
    std::array<std::uint8_t, kMaxDatagramBytes + 1> bytes_{};
    std::size_t size_;
};

inline std::uint32_t number_of(Bytes datagram) {
    std::uint32_t number = 0;
    std::memcpy(&number, datagram.data(), sizeof number);
    return number;
}

struct Arrival {
    std::uint32_t packet = 0;
    SessionTime time{};
    bool operator==(const Arrival&) const = default;
};

// Jumps from due time to due time until `end`, as the virtual loop does.
inline void drain(LinkModel& link, SessionTime end, std::vector<Arrival>& arrivals) {
    while (link.next_due() <= end) {
        const SessionTime now = link.next_due();
        for (Bytes out = link.pop_due(now); !out.empty(); out = link.pop_due(now)) {
            arrivals.push_back({number_of(out), now});
        }
    }
}

// Everything that comes out from now on.
inline std::vector<Arrival> drained(LinkModel& link) {
    std::vector<Arrival> arrivals;
    drain(link, kNever - Duration{1}, arrivals);
    return arrivals;
}

// `count` packets, one per period from time 0, and everything that comes out.
inline std::vector<Arrival> transmit(LinkModel& link, std::uint32_t count, Duration period = kMillisecond) {
    std::vector<Arrival> arrivals;
    for (std::uint32_t i = 0; i < count; ++i) {
        const SessionTime now = at(i * period);
        drain(link, now, arrivals);
        link.push(now, NumberedPacket(i).bytes());
    }
    drain(link, kNever - Duration{1}, arrivals);
    return arrivals;
}

}  // namespace thimble::test
