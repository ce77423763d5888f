// One sender and the packets that wait for it: rate with a limited queue, slots, or the opportunities of a recorded
// link. First in, first out. A passive stage: it is asked what has been sent until a time, and when to ask again.
// Times count from the start of the trial.
#pragma once

#include <optional>

#include "netem/link_settings.hpp"
#include "netem/packet_store.hpp"
#include "netem/stages/deliveries.hpp"
#include "netem/stages/slots.hpp"

namespace thimble {

class Transmitter {
  public:
    static constexpr Duration kNothing = Duration::max();

    Transmitter(const StreamKey& key, std::uint32_t direction, SessionTime start)
        : origin_(start), slots_(key, direction) {}

    // The packet in transmission ends as it began. Waiting packets go at the new rate.
    void configure(const LinkSettings& settings, Duration now);
    // Whether anything has to pass here.
    bool active() const { return active_ || !empty(); }
    bool empty() const { return sending_ == nullptr && waiting_.empty(); }

    // Whether a packet of `bytes` finds a place now (ask for what was sent until now first).
    bool has_room(std::size_t bytes) const;
    // Whether it would find room in an empty queue.
    bool could_hold(std::size_t bytes) const;
    void add(Packet* packet);
    // For head drop: the one that has waited longest, or null if none waits.
    Packet* drop_oldest();

    struct Sent {
        Packet* packet;
        Duration time;  // when its last bit was out
    };
    // A packet sent until `now`, one packet per call, in order.
    std::optional<Sent> take_sent(Duration now);
    // Nothing is sent before; kNothing if all is.
    Duration next_event() const;
    // The packet that the next event is about; not empty.
    const Packet* next_packet() const { return sending_ != nullptr ? sending_ : waiting_.front(); }
    // Any packet that is still here, or null: before a restart.
    Packet* take_any();

  private:
    Duration arrival(const Packet& packet) const { return from_nanoseconds(packet.received_ns) - origin_; }
    std::size_t bytes_on_air(const Packet& packet) const { return rate_.bytes_on_air(packet.size); }
    Duration time_on_air(const Packet& packet);  // of one that starts at start_
    bool sends_at_once() const;                  // a packet that comes now waits for nothing
    void plan_next();
    void begin();
    Packet* take_waiting();

    SessionTime origin_;
    RateSettings rate_{};
    const PacketTrace* trace_ = nullptr;  // only if it gives rates
    Slots slots_;
    Deliveries deliveries_;
    bool active_ = false;

    Packet* sending_ = nullptr;
    Duration done_{};  // of sending_
    PacketChain waiting_;
    std::size_t waiting_packets_ = 0, waiting_bytes_ = 0;
    Duration start_{};      // of the first that waits
    Duration free_at_{};    // when the last one was out
    double behind_ns_ = 0;  // how much of its time rounding has cut off, so that a busy link does not drift
    Duration earliest_{};   // of any start: when these settings came
};

}  // namespace thimble
