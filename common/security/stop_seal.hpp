// An end of a stop bus, protected. Everybody speaks to everybody there, also who is in no session (thimble stop), so it has no
// session's keys but a code under the lab key itself: 'T' 'S' | text | code, 16 bytes, keyed BLAKE2b of the way, the port and
// all before it. The way: what is said to a program, or what it answers, so that a stop that was overheard is nobody's answer.
//
// A recorded stop stops again whenever it is played, which jamming does as well. A recorded release passes here, and lets go of the
// one stop that it names and nothing else, wherever it is played (stop_bus.hpp): there is no clock to be wrong.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>

#include "common/channel.hpp"
#include "common/security/sealing.hpp"

namespace thimble {

enum class StopEnd { kListens, kSpeaks };

class StopSeal final : public Channel {
  public:
    static constexpr std::size_t kHeaderBytes = 2, kCodeBytes = 16;

    // `port`: the UDP port of the stop bus's listening end, here or there; at others nothing of this one counts. `wire` outlives it.
    StopSeal(Channel& wire, std::shared_ptr<const LabKey> lab, std::uint16_t port, StopEnd end)
        : wire_(&wire), lab_(std::move(lab)), port_(port), end_(end) {}

    void send(Bytes datagram) override;
    void answer(Bytes datagram) override;
    const SecurityCounters& counters() const { return counters_; }

  private:
    using StopCode = std::array<std::uint8_t, kCodeBytes>;
    Bytes take() override;
    StopCode code_of(Bytes said, std::string_view way) const;
    Bytes seal(Bytes datagram, std::string_view way);
    Bytes judge(Bytes datagram);

    Channel* wire_;
    std::shared_ptr<const LabKey> lab_;
    std::uint16_t port_;
    StopEnd end_;
    SecurityCounters counters_;
    alignas(16) std::array<std::uint8_t, kMaxDatagramBytes> text_{};  // where a message may be read
    std::array<std::uint8_t, kMaxDatagramBytes> sealed_{};
};

}  // namespace thimble
