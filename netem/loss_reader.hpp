// The key `loss` of a link: a number, with loss_burst beside it, or a table of its own.
//   [netem.force.loss]
//   model = "independent"      share
//   model = "gilbert"          share and mean_burst; or good_to_bad and bad_to_good
//   model = "gilbert-elliott"  good_to_bad, bad_to_good, loss_in_good, loss_in_bad
//   model = "four-state"       p13, p31, p32, p23, p14
#pragma once

#include "common/config.hpp"
#include "netem/link_settings.hpp"

namespace thimble {

// Packets in the mean, that a file may ask for.
inline constexpr double kLongestBurst = 1e6;

// Where the key is absent, `base`. Throws Error (usage).
LossSettings read_loss(const ConfigTable& link, const LossSettings& base);

}  // namespace thimble
