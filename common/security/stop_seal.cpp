#include "common/security/stop_seal.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <sodium.h>
#include <variant>

#include "common/codec.hpp"

namespace thimble {
namespace {

constexpr std::array<std::uint8_t, 2> kStopMagic{'T', 'S'};
constexpr int kMostRefusedStops = 64;  // as in a SecurePair
using StopCode = std::array<std::uint8_t, StopSeal::kCodeBytes>;

StopCode code_of_stop(const LabKey& lab, Bytes said) {
    constexpr std::array<std::uint8_t, 19> kLabel{'t', 'h', 'i', 'm', 'b', 'l', 'e', '-', '1', ' ',
                                                  's', 't', 'o', 'p', ' ', 'l', 'i', 'n', 'e'};
    StopCode code{};
    crypto_generichash_state state;
    crypto_generichash_init(&state, lab.bytes().data(), lab.bytes().size(), code.size());
    crypto_generichash_update(&state, kLabel.data(), kLabel.size());
    crypto_generichash_update(&state, said.data(), said.size());
    crypto_generichash_final(&state, code.data(), code.size());
    sodium_memzero(&state, sizeof state);
    return code;
}

}  // namespace

StopSeal::StopSeal(Channel& wire, std::shared_ptr<const LabKey> lab, RealtimeClock realtime_ns)
    : wire_(&wire), lab_(std::move(lab)), realtime_ns_(std::move(realtime_ns)) {}

void StopSeal::send(Bytes datagram) {
    if (datagram.size() > kMaxDatagramBytes - kHeaderBytes - kCodeBytes) {
        ++counters_.not_sent;
        return;
    }
    std::array<std::uint8_t, kMaxDatagramBytes> bytes{};
    std::copy(kStopMagic.begin(), kStopMagic.end(), bytes.begin());
    const auto now_ns = static_cast<std::uint64_t>(realtime_ns_());
    for (std::size_t i = 0; i < 8; ++i) bytes[2 + i] = static_cast<std::uint8_t>(now_ns >> (8 * i));
    const auto end = std::copy(datagram.begin(), datagram.end(), bytes.begin() + kHeaderBytes);
    const Bytes said{bytes.data(), kHeaderBytes + datagram.size()};
    const StopCode code = code_of_stop(*lab_, said);
    std::copy(code.begin(), code.end(), end);
    ++counters_.sealed;
    wire_->send({bytes.data(), said.size() + kCodeBytes});
}

Bytes StopSeal::take() {
    for (int refused = 0; refused < kMostRefusedStops; ++refused) {
        const Bytes datagram = wire_->receive();
        if (datagram.empty()) return {};
        const Bytes text = judge(datagram);
        if (!text.empty()) return text;
    }
    return {};
}

Bytes StopSeal::judge(Bytes datagram) {
    const bool ours = datagram.size() > kHeaderBytes + kCodeBytes && datagram.size() <= kMaxDatagramBytes &&
                      std::equal(kStopMagic.begin(), kStopMagic.end(), datagram.begin());
    if (!ours) {
        ++counters_.unsealed;
        return {};
    }
    const Bytes said = datagram.first(datagram.size() - kCodeBytes);
    if (!same_bytes(code_of_stop(*lab_, said), datagram.last(kCodeBytes))) {
        ++counters_.forged;
        return {};
    }
    std::uint64_t made_ns = 0;
    for (std::size_t i = 0; i < 8; ++i) made_ns |= std::uint64_t{datagram[2 + i]} << (8 * i);
    const auto end = std::copy(said.begin() + kHeaderBytes, said.end(), text_.begin());
    const Bytes text{text_.data(), static_cast<std::size_t>(end - text_.begin())};
    if (too_old(text, static_cast<std::int64_t>(made_ns))) {
        ++counters_.replayed;
        return {};
    }
    ++counters_.opened;
    return text;
}

// Of releases only: whoever stops is heard whatever the clocks say.
bool StopSeal::too_old(Bytes text, std::int64_t made_ns) {
    if (decode_into(text, message_) != Refusal::kCount) return false;
    const auto* order = std::get_if<StopOrder>(&message_.body);
    if (order == nullptr || order->kind != StopKind::kRelease) return false;
    const std::int64_t limit_ns = Duration(kReleaseHolds).count(), now_ns = realtime_ns_();
    return made_ns > now_ns + limit_ns || made_ns < now_ns - limit_ns;
}

}  // namespace thimble
