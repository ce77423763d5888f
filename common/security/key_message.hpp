// Messages between session and node about the keys of one-way flows, inside their secured control channel. Little endian.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/security/sealing.hpp"
#include "common/security/secret.hpp"

namespace thimble {

struct FlowKey {
    Port port = Port::kCount;
    SecretKey key;
};
inline constexpr std::size_t kMostFlowKeys = 8;  // of one node

// Session to node: the keys of one epoch of one session. Not yet in use: the node opens with them, and seals as before.
struct KeyGrant {
    std::uint64_t session = 0;
    std::uint32_t epoch = 0;
    bool in_use = false;
    std::size_t count = 0;
    std::array<FlowKey, kMostFlowKeys> keys;
};
// Node to session: has it, and uses it.
struct KeyReceipt {
    std::uint32_t epoch = 0;
    bool in_use = false;
};

using KeyText = std::array<std::uint8_t, kMaxSealedTextBytes>;
// Returns the part of `out` that is used.
Bytes write_grant(const KeyGrant& grant, KeyText& out);
std::optional<KeyGrant> read_grant(Bytes text);
Bytes write_receipt(const KeyReceipt& receipt, KeyText& out);
std::optional<KeyReceipt> read_receipt(Bytes text);

}  // namespace thimble
