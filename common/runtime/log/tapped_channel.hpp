// A channel whose datagrams are written down as they pass: what is sent, and what is received, both as the node sees them.
#pragma once

#include <cstdint>

#include "common/channel.hpp"
#include "common/log/byte_queue.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {

class TappedChannel final : public Channel {
  public:
    // `sent` and `received`: what the queue's reader knows the two ways by. `granted`: the time in lock-step; kNever: the wall
    // clock's holds. All outlive this.
    TappedChannel(Channel& inner, ByteQueue& queue, std::uint16_t sent, std::uint16_t received,
                  const SessionTime& granted = kNever)
        : inner_(inner), queue_(queue), sent_(sent), received_(received), granted_(granted) {}

    void send(Bytes datagram) override {
        inner_.send(datagram);  // first: writing it down is not to delay it
        note(sent_, datagram);
    }
    void answer(Bytes datagram) override {
        inner_.answer(datagram);
        note(sent_, datagram);
    }
    std::optional<SessionTime> arrival() const override { return inner_.arrival(); }

  private:
    Bytes take() override {
        const Bytes datagram = inner_.receive();
        if (!datagram.empty()) note(received_, datagram);
        return datagram;
    }
    void note(std::uint16_t tag, Bytes datagram) {
        queue_.push(tag, to_nanoseconds(granted_ == kNever ? wall_now() : granted_), datagram);
    }

    Channel& inner_;
    ByteQueue& queue_;
    std::uint16_t sent_, received_;
    const SessionTime& granted_;
};

}  // namespace thimble
