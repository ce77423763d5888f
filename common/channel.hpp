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
struct SharedMessage;
class MessagePool;

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

    // Where the peer may move (UdpChannel): send_back() sends to the sender of the last received datagram once,
    // follow() makes it the new peer. Any other channel has one peer.
    virtual void send_back(Bytes datagram) { send(datagram); }
    virtual void follow() {}

    // The next waiting datagram, or an empty span. Valid until the next call on this channel.
    Bytes receive() { return known_empty() ? Bytes{} : take(); }
    // True if receive() is sure to find nothing. Invalidates the span that receive() returned. Cheap: every flow asks
    // at every tick.
    bool known_empty() { return released_ = known_empty_; }

    // When the datagram that receive() returned last had reached this machine, if the channel measures that: at most a
    // few microseconds late, never early. None: take the tick's own time.
    virtual std::optional<SessionTime> arrival() const { return std::nullopt; }

    // Within one program a message may go as it is, without bytes (shared_message.hpp). Null: this channel sends bytes only.
    MessagePool* pool() const { return pool_; }
    // Only where there is a pool, and of a message from it.
    virtual void hand_over(SharedMessage& /*message*/) {}
    // The next that waits if it was handed over, valid until the next call on this channel. Null: receive() has the next, if any.
    SharedMessage* receive_shared() { return shared_waits_ ? take_shared() : nullptr; }

  protected:
    virtual Bytes take() = 0;
    virtual SharedMessage* take_shared() { return nullptr; }
    MessagePool* pool_ = nullptr;
    bool shared_waits_ = false;  // the next that waits was handed over
    // Set by a channel that knows its own queue; others leave it false.
    bool known_empty_ = false;
    bool released_ = false;  // the caller is done with the last span
};

}  // namespace thimble
