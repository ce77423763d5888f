// How many packets a link loses by chance: the exact distribution of that number, for any loss model, timeline and trace.
// Packet by packet the probability of each number lost so far is followed, together with the state of the loss chain.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "netem/relay/selftest_twin.hpp"

namespace thimble {

class LossLaw {
  public:
    // `received`: when each packet came, not decreasing. Takes time in proportion to packets times losses expected.
    LossLaw(const TwinLink& link, std::span<const SessionTime> received);

    double mean() const;
    // Of links with other seeds, the share that loses a number as far out as this one, on either side: 0 to 1.
    double chance_of(std::uint64_t lost) const;

  private:
    using States = std::array<double, 4>;
    // Where a packet is lost with the probability of the state it finds. Fewer states: the others are never reached.
    struct Chain {
        explicit Chain(const LossSettings& settings);
        States stationary{1}, lost{};
        std::array<States, 4> move{{{1}}};  // from, to
    };

    void begin(const Chain& chain);
    void move(const Chain& chain);
    void lose(const States& probability);
    void trim();
    double at(std::size_t lost) const;

    std::vector<States> share_;       // by number lost, then by state
    std::size_t low_ = 0, high_ = 0;  // numbers outside are next to impossible
};

}  // namespace thimble
