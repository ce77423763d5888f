// Link settings as people write them, one table per direction:
//   delay_s = 0.05            mean one-way delay, 0 to 60
//   jitter = "normal"         "none", "uniform" or "normal"
//   jitter_spread_s = 0.005   half width (uniform) or standard deviation (normal)
//   loss = 0.01               probability, 0 to 1
//   in_order = true           false: packets may overtake each other
//   capacity = 4096           packets in flight; by itself at least twice what the delay needs at 1 kHz
#pragma once

#include "common/config.hpp"
#include "netem/link_settings.hpp"

namespace thimble {

// Throws Error (usage) also for settings that contradict each other: a spread without jitter or the reverse,
// a spread so wide that cutting delays at 0 would move their mean, a capacity that the delay alone fills.
LinkSettings read_link_settings(const ConfigTable& table);

}  // namespace thimble
