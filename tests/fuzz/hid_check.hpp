// The input of a hostile HID device: its descriptor, and reports of a hand and of a fingertip board.
#pragma once

#include <cstdint>
#include <span>

#include "tests/fuzz/verdict.hpp"

namespace thimble {

// The first byte says how long the descriptor is; what follows it are reports of the same length.
Verdict check_hid_bytes(std::span<const std::uint8_t> bytes);

}  // namespace thimble
