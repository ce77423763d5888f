// One end of a stop bus, authenticated. Programs outside every session (thimble stop) use it too, so its key is the
// lab key itself.
//     'T' 'S' | text | code
// The code is 16 bytes: keyed BLAKE2b of the direction, the port and all bytes before it.
// The direction tells questions from answers, so that a recorded stop cannot pass for an answer.
//
// A recorded stop can be replayed; jamming has the same effect. A recorded release can be replayed too, but it
// releases only the one stop that it names (stop_bus.hpp). No check needs a clock.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>

#include "common/channel.hpp"
#include "common/security/keyed_hash.hpp"
#include "common/security/sealing.hpp"

namespace thimble {

inline constexpr std::array<std::uint8_t, 2> kStopMagic{'T', 'S'};

inline constexpr std::string_view kSaid = "thimble-1 stop bus", kAnswered = "thimble-1 stop bus answer";

enum class StopEnd { kListens, kSpeaks };

class StopSeal final : public Channel {
  public:
    static constexpr std::size_t kHeaderBytes = 2, kCodeBytes = 16;

    // `port`: the UDP port of the stop bus's listening end, here or there; at others nothing of this one counts. `wire` outlives it.
    StopSeal(Channel& wire, std::shared_ptr<const LabKey> lab, std::uint16_t port, StopEnd end)
        : wire_(&wire), lab_(std::move(lab)), port_(port), end_(end) {}

    void send(Bytes datagram) override {
        if (const Bytes sealed = seal(datagram, kSaid); !sealed.empty()) wire_->send(sealed);
    }

    void answer(Bytes datagram) override {
        if (const Bytes sealed = seal(datagram, kAnswered); !sealed.empty()) wire_->answer(sealed);
    }

    const SecurityCounters& counters() const { return counters_; }

  private:
    using StopCode = std::array<std::uint8_t, kCodeBytes>;
    Bytes take() override {
        return receive_judged(*wire_, [this](Bytes datagram) { return judge(datagram); });
    }

    StopCode code_of(Bytes said, std::string_view way) const {
        std::array<std::uint8_t, 2> port{};
        write_little_endian(port_, port.data());
        StopCode code{};
        KeyedHash(lab_->bytes(), code.size()).add(way).add(port).add(said).finish(code);
        return code;
    }

    // Empty if the text is too long for a datagram.
    Bytes seal(Bytes datagram, std::string_view way) {
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

    Bytes judge(Bytes datagram) {
        const bool ours = datagram.size() > kHeaderBytes + kCodeBytes &&
                          datagram.size() <= kMaxDatagramBytes &&
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

    Channel* wire_;
    std::shared_ptr<const LabKey> lab_;
    std::uint16_t port_;
    StopEnd end_;
    SecurityCounters counters_;
    alignas(16) std::array<std::uint8_t, kMaxDatagramBytes> text_{};  // where a message may be read
    std::array<std::uint8_t, kMaxDatagramBytes> sealed_{};
};

}  // namespace thimble
