#pragma once

#include <cstdint>
#include <vector>

#include "common/channel.hpp"

namespace thimble {

using Packet = std::vector<std::uint8_t>;

inline Packet copy(Bytes bytes) { return {bytes.begin(), bytes.end()}; }

}  // namespace thimble
