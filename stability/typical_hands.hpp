// Five hands that the stability study looks at, from a light pinch to a power grip (sources: docs/stability.md).
#pragma once

#include <array>

#include "stability/critical_delay.hpp"

namespace thimble {

struct TypicalHand {
    const char* name = "";  // a letter, then what it is
    HeldMass hand;
};
inline constexpr std::array<TypicalHand, 5> kTypicalHands{{{"A light pinch", {0.15, 3, 300}},
                                                           {"B pinch", {0.35, 6, 400}},
                                                           {"C measured arm", {0.55, 6.45, 135}},
                                                           {"D firm grip", {1, 20, 500}},
                                                           {"E power grip", {2, 40, 1000}}}};

}  // namespace thimble
