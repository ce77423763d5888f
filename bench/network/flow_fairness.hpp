// Many flows through one relay: whether each gets its share, also beside one that wants more than all others together.
#pragma once

#include <cstddef>

#include "common/time.hpp"

namespace thimble {

struct FairnessRound {
    double offered_per_s = 0;    // datagrams, all flows together
    double delivered = 0;        // share of them, all flows together
    double least = 0, most = 0;  // share that a flow got through, without the greedy one
    double index = 0;  // (sum x)^2 / (n sum x^2) of these shares (Jain, Chiu and Hawe 1984); 1: all equal
    double late50_us = 0, late99_us = 0;  // from due time to sent, without the greedy one
    double dropped_by_kernel = 0;         // share of all: the relay did not read in time
};

// `flows` clients at 20 Hz each and, if `greedy_per_s` is not 0, one more at that; 144 bytes, 50 ms, sleeping.
FairnessRound share_relay(std::size_t flows, double greedy_per_s, Duration length);

}  // namespace thimble
