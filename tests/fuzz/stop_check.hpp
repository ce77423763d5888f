// The input at an end of the stop bus, with the lab key and without.
#pragma once

#include <cstdint>
#include <span>

#include "tests/fuzz/verdict.hpp"

namespace thimble {

// A script of moves at a sealed end: bytes made up, genuine stops and releases changed or repeated, genuine ones, and time. Only a genuine stop stops, and only a genuine release releases. Accepted: it was stopped.
Verdict check_stop_script(std::span<const std::uint8_t> script);
// One datagram at an open end: it stops if it is a stop, is refused by name, or does nothing.
Verdict check_stop_bytes(std::span<const std::uint8_t> bytes);

}  // namespace thimble
