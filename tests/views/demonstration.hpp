// A trial as the Monitor would tell it: the needle goes in, meets the fixture and oscillates there at 15 Hz, as with 50 ms of
// delay, while the port gives out energy. A pure function of time: what a picture of it must show is known.
#pragma once

#include "common/messages.hpp"

namespace thimble {

inline constexpr double kDemonstrationFixture_m = 0.123;
inline constexpr double kDemonstrationAmplitude_m = 0.004;
inline constexpr double kDemonstrationContact_s = 3;  // when it gets there

Monitor demonstration(double time_s);

}  // namespace thimble
