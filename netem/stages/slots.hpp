// A medium that sends in bursts: slots open at instants, and each takes what waits then, up to its limits. The first
// opens at the start of the trial (or when slots are switched on), and the time from slot k to the next is drawn by
// k: the grid does not depend on the traffic. (netem draws it when a packet finds the last slot over.) A pause of more
// than kMostSteps slots keeps the distribution of the grid. Its instants then depend on when the pause ended.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "netem/link_settings.hpp"
#include "netem/stages/packet_numbers.hpp"

namespace thimble {

class Slots {
  public:
    // The model counts at most this many unused slots one by one, so that one packet never takes long.
    static constexpr std::int64_t kMostSteps = 8192;

    Slots(const StreamKey& key, std::uint32_t direction)
        : numbers_(link_key(key, direction, Purpose::kLinkSlot)) {}

    void configure(const SlotSettings& settings, Duration now);
    bool active() const { return settings_.most > Duration::zero(); }

    // When a packet that came at `arrival` may go, if the medium is taken until `free_at`: with the slot that is open
    // then if it came before that opened, or with a later one. Never goes back; asking twice changes nothing.
    Duration opening(Duration arrival, Duration free_at, std::size_t bytes);
    // It goes with that slot.
    void take(std::size_t bytes);

  private:
    bool is_full(std::size_t bytes) const;
    void advance();
    void jump_towards(Duration time);
    bool jump_over_many(Duration time);

    PacketNumbers numbers_;
    SlotSettings settings_{};
    std::uint64_t slot_ = 0;
    Duration opens_{}, next_opens_{};
    std::size_t packets_ = 0, bytes_ = 0;  // gone with this slot
};

// When nothing gets through. Packets that are on their way still arrive.

// `time` since the start of the trial. An outage holds from its start until just before its end.
bool is_out(const std::vector<Outage>& outages, Duration time);

}  // namespace thimble
