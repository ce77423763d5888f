// Hostile bytes at both ends of a CAN bus.
#pragma once

#include "common/channel.hpp"

namespace thimble {

// Takes them as a datagram of cannelloni, and as frames (13 bytes each: identifier, length, data) that the master of twelve
// drives hears, and a drive. The broken promise; null if there is none.
const char* flaw_of_bus(Bytes bytes);

}  // namespace thimble
