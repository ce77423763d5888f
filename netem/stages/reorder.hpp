// Which packets skip the delay and so overtake those before them, as in Linux's netem: after gap - 1 delayed packets
// each one skips with the probability p given, until one does. So a share p / (1 + (gap - 1) p) skips.
#pragma once

#include "netem/stages/packet_numbers.hpp"

namespace thimble {

class Reorder {
  public:
    Reorder(const StreamKey& key, std::uint32_t direction)
        : numbers_(link_key(key, direction, Purpose::kLinkReorder)) {}

    // Other settings start the count of delayed packets anew.
    void configure(double probability, unsigned gap) {
        if (probability != probability_ || gap != gap_) delayed_ = 0;
        probability_ = probability;
        gap_ = gap;
    }
    // Asked once for each packet that is not lost, in order.
    bool skips(std::uint64_t packet) {
        if (probability_ <= 0) return false;
        const bool skips = delayed_ + 1 >= gap_ && numbers_.uniform(packet) < probability_;
        delayed_ = skips ? 0 : delayed_ + 1;
        return skips;
    }

  private:
    PacketNumbers numbers_;
    double probability_ = 0;
    unsigned gap_ = 1;
    std::uint64_t delayed_ = 0;  // since the last that skipped
};

}  // namespace thimble
