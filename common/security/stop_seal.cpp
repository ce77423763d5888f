#include "common/security/stop_seal.hpp"

#include <algorithm>

#include "common/security/keyed_hash.hpp"
#include "common/security/sealing.hpp"

namespace thimble {
namespace {

constexpr std::array<std::uint8_t, 2> kStopMagic{'T', 'S'};
constexpr std::string_view kSaid = "thimble-1 stop bus", kAnswered = "thimble-1 stop bus answer";

}  // namespace

StopSeal::StopCode StopSeal::code_of(Bytes said, std::string_view way) const {
    std::array<std::uint8_t, 2> port{};
    write_little_endian(port_, port.data());
    StopCode code{};
    KeyedHash(lab_->bytes(), code.size()).add(way).add(port).add(said).finish(code);
    return code;
}

void StopSeal::send(Bytes datagram) {
    if (const Bytes sealed = seal(datagram, kSaid); !sealed.empty()) wire_->send(sealed);
}

void StopSeal::answer(Bytes datagram) {
    if (const Bytes sealed = seal(datagram, kAnswered); !sealed.empty()) wire_->answer(sealed);
}

// Empty for a text that fits no datagram.
Bytes StopSeal::seal(Bytes datagram, std::string_view way) {
    if (datagram.size() > kMaxDatagramBytes - kHeaderBytes - kCodeBytes) {
        ++counters_.not_sent;
        return {};
    }
    std::copy(kStopMagic.begin(), kStopMagic.end(), sealed_.begin());
    const auto end = std::copy(datagram.begin(), datagram.end(), sealed_.begin() + kHeaderBytes);
    const Bytes said{sealed_.data(), kHeaderBytes + datagram.size()};
    const StopCode code = code_of(said, way);
    std::copy(code.begin(), code.end(), end);
    ++counters_.sealed;
    return {sealed_.data(), said.size() + kCodeBytes};
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
    if (!same_bytes(code_of(said, end_ == StopEnd::kListens ? kSaid : kAnswered),
                    datagram.last(kCodeBytes))) {
        ++counters_.forged;
        return {};
    }
    const auto end = std::copy(said.begin() + kHeaderBytes, said.end(), text_.begin());
    ++counters_.opened;
    return {text_.data(), static_cast<std::size_t>(end - text_.begin())};
}

}  // namespace thimble
