// Which velocity estimator a session's configuration file chooses, and its numbers.
#pragma once

#include "common/config.hpp"
#include "common/velocity_estimator.hpp"

namespace thimble {

// The keys velocity_* of table [master]. Throws Error (usage), also for a number that the chosen estimator does
// not use: it would be without effect. The quantum's default is the paper's encoder seen at the needle,
// position_scale x 0.01 mm.
VelocitySettings read_velocity_settings(const ConfigTable& table, Duration sample_period,
                                        double position_scale);

}  // namespace thimble
