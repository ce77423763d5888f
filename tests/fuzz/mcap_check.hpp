// Hostile logs.
#pragma once

#include "common/channel.hpp"

namespace thimble {

// Reads them as an MCAP file, and what is whole of them into a new one, which must then be whole and hold the same messages.
// The broken promise; null if there is none.
const char* flaw_of_log(Bytes bytes);

}  // namespace thimble
