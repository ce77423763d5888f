// mahimahi's packet-delivery traces: a whole number of milliseconds per line, not falling; each line lets 1500 bytes
// through at that time, and the last one is where the trace begins again.
#pragma once

#include <string>
#include <string_view>

#include "netem/delivery_trace.hpp"

namespace thimble {

// Throws Error (data) with file and line.
DeliveryTrace parse_delivery_trace(std::string_view text, std::string_view name);
std::string print_delivery_trace(const DeliveryTrace& trace);

}  // namespace thimble
