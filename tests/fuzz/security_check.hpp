// The input of an attacker without the lab key, to both ends of a handshake and to the end of a sealed flow.
#pragma once

#include <cstdint>
#include <span>

#include "tests/fuzz/verdict.hpp"

namespace thimble {

// A script of moves: bytes made up, genuine datagrams changed, repeated or turned back, and genuine progress in between.
Verdict check_handshake_bytes(std::span<const std::uint8_t> script);
// A datagram for a flow's end, and the same bytes as words about keys, which only a peer can say.
Verdict check_sealed_bytes(std::span<const std::uint8_t> bytes);

}  // namespace thimble
