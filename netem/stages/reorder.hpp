// Which packets skip the delay and so overtake those before them. Packets are counted in groups of `gap`; only the
// last of each may skip, with the probability given. (netem, after gap - 1 delayed packets, tries each one until it
// succeeds; here the fate of a packet depends on no other's.)
#pragma once

#include "netem/stages/packet_numbers.hpp"

namespace thimble {

class Reorder {
  public:
    Reorder(const StreamKey& key, std::uint32_t direction)
        : numbers_(link_key(key, direction, Purpose::kLinkReorder)) {}

    void configure(double probability, unsigned gap) {
        probability_ = probability;
        gap_ = gap == 0 ? 1 : gap;
    }
    bool skips(std::uint64_t packet) {
        return probability_ > 0 && packet % gap_ == gap_ - 1 && numbers_.uniform(packet) < probability_;
    }

  private:
    PacketNumbers numbers_;
    double probability_ = 0;
    std::uint64_t gap_ = 1;
};

}  // namespace thimble
