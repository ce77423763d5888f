// What `irtt client -o FILE.json` writes (irtt-client(1), "JSON FORMAT"): both directions of a path.
#pragma once

#include <string_view>

#include "netem/formats/measured_path.hpp"

namespace thimble {

struct MeasuredPaths {
    MeasuredPath up, down;  // client to server, server to client
};

// Times are the client's sends, also for `down` (the server answers at once). With the server's stamps the delays
// are one-way, as good as the two clocks agree, which a remark judges; without them each is half of the round trip. A
// packet lost where irtt cannot tell counts as lost upwards. Throws Error (data) naming the entry.
MeasuredPaths parse_irtt(std::string_view text, std::string_view name);

}  // namespace thimble
