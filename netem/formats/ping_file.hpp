// What ping prints: iputils (also with -D, its time stamps, and -O, its "no answer yet"), busybox, BSD and macOS.
#pragma once

#include <string_view>

#include "netem/formats/measured_path.hpp"

namespace thimble {

// Each delay is half of the round trip, the same for both directions: ping cannot tell them apart, and a remark says
// so. Losses are the numbers missing between the first and the last, and at the end what the summary says was
// sent. With time stamps (-D) a lost packet stands between its neighbours; without, `interval` stands between two
// packets (ping's -i, 1 s by itself). Throws Error (data) with file and line.
MeasuredPath parse_ping(std::string_view text, std::string_view name, Duration interval);

}  // namespace thimble
