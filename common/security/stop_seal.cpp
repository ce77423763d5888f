#include "common/security/stop_seal.hpp"

#include <algorithm>
#include <variant>

#include "common/codec.hpp"
#include "common/security/byte_order.hpp"
#include "common/security/keyed_hash.hpp"
#include "common/security/refusing_receive.hpp"

namespace thimble {
namespace {

constexpr std::array<std::uint8_t, 2> kStopMagic{'T', 'S'};
using StopCode = std::array<std::uint8_t, StopSeal::kCodeBytes>;

StopCode code_of_stop(const LabKey& lab, Bytes said) {
    StopCode code{};
    KeyedHash(lab.bytes(), code.size()).add("thimble-1 stop line").add(said).finish(code);
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
    write_little_endian(static_cast<std::uint64_t>(realtime_ns_()), &bytes[kStopMagic.size()]);
    const auto end = std::copy(datagram.begin(), datagram.end(), bytes.begin() + kHeaderBytes);
    const Bytes said{bytes.data(), kHeaderBytes + datagram.size()};
    const StopCode code = code_of_stop(*lab_, said);
    std::copy(code.begin(), code.end(), end);
    ++counters_.sealed;
    wire_->send({bytes.data(), said.size() + kCodeBytes});
}

Bytes StopSeal::take() {
    return receive_judged(*wire_, [this](Bytes datagram) { return judge(datagram); });
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
    const auto made_ns = read_little_endian<std::uint64_t>(&datagram[kStopMagic.size()]);
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
