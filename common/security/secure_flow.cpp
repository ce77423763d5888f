#include "common/security/secure_flow.hpp"

#include "common/security/sealing.hpp"

namespace thimble {

Bytes SecureInlet::take() {
    return receive_judged(*wire_, [this](Bytes datagram) { return open(datagram); });
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
