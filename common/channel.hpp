// The first seam: datagrams out, datagrams in. Real: UDP (runtime/udp_channel.hpp). Virtual time:
// queue_channel.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "common/time.hpp"

namespace thimble {

// Larger than any message, small enough never to be fragmented.
inline constexpr std::size_t kMaxDatagramBytes = 512;

using Bytes = std::span<const std::uint8_t>;

// So many datagrams that are refused, or only passed on, are taken from a channel in a row. A flood must not hold a tick: the rest
// waits for the next one, which comes at once while there is mail.
inline constexpr int kMostRefusedAtOnce = 64;

class Channel {
  public:
    virtual ~Channel() = default;
    Channel() = default;
    Channel(const Channel&) = delete;
    Channel& operator=(const Channel&) = delete;

    // Never blocks. A datagram that cannot be sent is lost, as on any network, and counted by the channel.
    virtual void send(Bytes datagram) = 0;

    // To whoever sent what receive() gave last, where the channel knows him; elsewhere nothing.
    virtual void answer(Bytes) {}

    // The next waiting datagram, or an empty span. Valid until the next call on this channel.
    Bytes receive() { return known_empty() ? Bytes{} : take(); }
    // True if receive() is sure to find nothing; a call, too, that ends what receive() gave. Cheap: every flow
    // asks at every tick.
    bool known_empty() { return released_ = known_empty_; }

    // When the datagram that receive() returned last had reached this machine, if the channel measures that: at most a
    // few microseconds late, never early. None: take the tick's own time.
    virtual std::optional<SessionTime> arrival() const { return std::nullopt; }

  protected:
    virtual Bytes take() = 0;
    // For a channel that knows what waits in it; one that does not leaves it false.
    bool known_empty_ = false;
    bool released_ = false;  // what was taken last is not looked at any more
};

}  // namespace thimble
