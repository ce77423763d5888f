// When nothing gets through. What is on its way already still arrives.
#pragma once

#include <vector>

#include "netem/link_settings.hpp"

namespace thimble {

// `time` since the start of the trial. An outage holds from its start until just before its end.
bool is_out(const std::vector<Outage>& outages, Duration time);

}  // namespace thimble
