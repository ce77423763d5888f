// How wide a delay may spread around its mean before cutting delays at 0 moves that mean.
#pragma once

#include "netem/link_settings.hpp"

namespace thimble {

// kUniform ends at its half width, kPareto 0.577 spreads below the mean, kGamma at 0 whatever its spread (ten times the
// mean is as skewed as anybody means); at two standard deviations the cut moves the others by less than 1 % of one.
constexpr Duration widest_spread(JitterShape shape, Duration delay) {
    switch (shape) {
        case JitterShape::kUniform:
            return delay;
        case JitterShape::kPareto:
            return delay * 17 / 10;
        case JitterShape::kGamma:
            return delay * 10;
        default:
            return delay / 2;
    }
}

}  // namespace thimble
