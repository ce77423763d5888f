// A relay's state in the text format of Prometheus (version 0.0.4).
#pragma once

#include <string>

#include "netem/relay/relay_totals.hpp"

namespace thimble {

std::string metrics_text(const RelayState& state);

}  // namespace thimble
