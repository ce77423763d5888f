// Which packets arrive twice. Both copies carry the same bytes; the second has a delay of its own and, like the
// first, takes its turn at the transmitter.
#pragma once

#include "netem/stages/packet_numbers.hpp"

namespace thimble {

class Duplicate {
  public:
    Duplicate(const StreamKey& key, std::uint32_t direction)
        : numbers_(link_key(key, direction, Purpose::kLinkDuplicate)) {}

    void configure(double probability) { probability_ = probability; }
    bool twice(std::uint64_t packet) { return probability_ > 0 && numbers_.uniform(packet) < probability_; }

  private:
    PacketNumbers numbers_;
    double probability_ = 0;
};

}  // namespace thimble
