// An end of a stop line, protected. Everybody speaks to everybody there, also who is in no session (thimble stop), so it has no
// session's keys but a code under the lab key itself: 'T' 'S' | the sender's realtime clock in ns, 8 bytes, little endian | text |
// code, 16 bytes, keyed BLAKE2b of all before it.
//
// A recorded stop stops again whenever it is played, which jamming does as well. A recorded release lets go of nothing: its number is
// remembered where it was heard, and elsewhere it is too old (kReleaseHolds), as one from a machine whose clock is that wrong.
#pragma once

#include <array>
#include <functional>
#include <memory>

#include "common/messages.hpp"
#include "common/security/sealing.hpp"

namespace thimble {

class StopSeal final : public Channel {
  public:
    using RealtimeClock = std::function<std::int64_t()>;  // ns
    static constexpr std::size_t kHeaderBytes = 10, kCodeBytes = 16;
    static constexpr Duration kReleaseHolds = std::chrono::seconds{60};

    // `wire` outlives it.
    StopSeal(Channel& wire, std::shared_ptr<const LabKey> lab, RealtimeClock realtime_ns);

    void send(Bytes datagram) override;
    const SecurityCounters& counters() const { return counters_; }

  private:
    Bytes take() override;
    Bytes judge(Bytes datagram);
    bool too_old(Bytes text, std::int64_t made_ns);

    Channel* wire_;
    std::shared_ptr<const LabKey> lab_;
    RealtimeClock realtime_ns_;
    SecurityCounters counters_;
    alignas(16) std::array<std::uint8_t, kMaxDatagramBytes> text_{};  // where a message may be read
    Message message_;
};

}  // namespace thimble
