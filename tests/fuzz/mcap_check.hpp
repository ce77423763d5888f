// Hostile logs.
#pragma once

#include "common/channel.hpp"

namespace thimble {

// Reads them as an MCAP file, and what is whole of them into a new one, which must then be whole and hold the same messages.
// What is wrong then; null if nothing is.
const char* flaw_of_log(Bytes bytes);

}  // namespace thimble
