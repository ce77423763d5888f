// The first seam: datagrams out, datagrams in. Real: UDP (runtime/udp_channel.hpp). Virtual time:
// queue_channel.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <boost/core/noncopyable.hpp>

#include "common/time.hpp"

namespace thimble {

// Larger than any message, small enough never to be fragmented.
inline constexpr std::size_t kMaxDatagramBytes = 512;

using Bytes = std::span<const std::uint8_t>;

// The most datagrams without a message for the caller that one call takes from a channel. A flood must not hold a tick: the rest
// waits for the next one, which comes at once while there is mail.
inline constexpr int kMostRefusedAtOnce = 64;

class Channel : boost::noncopyable {
  public:
    virtual ~Channel() = default;

    // Never blocks. A datagram that cannot be sent is lost, as on any network, and counted by the channel.
    virtual void send(Bytes datagram) = 0;

    // Answers the sender of the last received datagram, if the channel knows it. Else it does nothing.
    virtual void answer(Bytes) {}

    // Of a channel whose peer may move (UdpChannel): to the sender of the last received datagram, once, or from now on. Any other has
    // one peer.
    virtual void send_back(Bytes datagram) { send(datagram); }
    virtual void follow() {}

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
