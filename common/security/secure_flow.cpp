#include "common/security/secure_flow.hpp"

namespace thimble {
namespace {

// As in a SecurePair: a flood waits for the next tick.
constexpr int kMostRefusedInFlow = 64;

}  // namespace

Bytes SecureInlet::take() {
    for (int refused = 0; refused < kMostRefusedInFlow; ++refused) {
        const Bytes datagram = wire_->receive();
        if (datagram.empty()) return {};
        const Bytes text = open(datagram);
        if (!text.empty()) return text;
    }
    return {};
}

Bytes SecureInlet::open(Bytes datagram) {
    const auto header = read_seal_header(datagram);
    if (!header) {
        ++counters_.unsealed;
    } else if (header->port != port_ || header->kind != PacketKind::kData) {
        ++counters_.wrong_role;
    } else if (Opener* const opener = openers_.find(*header); opener == nullptr) {
        ++counters_.no_key;
    } else if (const auto size = opener->open(*header, datagram, text_, counters_)) {
        return {text_.data(), *size};
    }
    return {};
}

}  // namespace thimble
