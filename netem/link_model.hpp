// The one thing in Thimble that delays: a passive, seeded pipeline for one direction of one flow. Time is an
// argument; the relay process uses it in real time and the virtual loop in virtual time, with the same fate for each
// packet. The order of its stages (docs/network.md):
//   loss -> outage -> corruption -> duplication -> transmitter (rate, slots or recorded deliveries) -> delay -> order
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "common/channel.hpp"
#include "common/random.hpp"
#include "common/time.hpp"
#include "netem/delay_line.hpp"
#include "netem/link_fates.hpp"
#include "netem/link_observer.hpp"
#include "netem/link_settings.hpp"
#include "netem/packet_store.hpp"
#include "netem/stages/transmitter.hpp"

namespace thimble {

// The most that UDP over IPv4 carries.
inline constexpr std::size_t kLargestDatagramBytes = 65507;

// RFC 3168, of a traffic class: either bit says that the sender understands ECN, both say that the packet met congestion.
inline constexpr std::uint8_t kCongestionExperienced = 3;

// Since the last restart.
//   pushed + duplicated = lost + outage + oversized + queue_full + overflowed + delivered + in flight
struct LinkCounters {
    std::uint64_t pushed = 0;
    std::uint64_t lost = 0, outage = 0, oversized = 0, queue_full = 0, overflowed = 0;  // as in DropReason
    std::uint64_t delivered = 0;
    std::uint64_t duplicated = 0;  // second copies made
    std::uint64_t corrupted = 0;   // packets with flipped bits
    std::uint64_t skipped = 0;     // packets that the reorder stage let go without delay
    std::uint64_t marked = 0;      // packets that were marked instead of lost (LinkSettings::ecn)
    std::uint64_t reordered = 0;   // delivered after a later one (RFC 4737); copies do not count

    LinkCounters& operator+=(const LinkCounters& other);
};

// By name, in the order of reports.
struct LinkCounter {
    std::string_view name;
    std::uint64_t LinkCounters::*value;
};
inline constexpr std::array<LinkCounter, 10> kReportedCounters{{{"pushed", &LinkCounters::pushed},
                                                                {"delivered", &LinkCounters::delivered},
                                                                {"lost", &LinkCounters::lost},
                                                                {"outage", &LinkCounters::outage},
                                                                {"queue_full", &LinkCounters::queue_full},
                                                                {"overflowed", &LinkCounters::overflowed},
                                                                {"oversized", &LinkCounters::oversized},
                                                                {"duplicated", &LinkCounters::duplicated},
                                                                {"corrupted", &LinkCounters::corrupted},
                                                                {"reordered", &LinkCounters::reordered}}};

// The real waiting times of delivered packets, from push to pop, since the last restart.
struct LinkDelays {
    Duration sum{};
    Duration min = Duration::max();  // as long as count is 0
    Duration max{};
    std::uint64_t count = 0;

    double mean_s() const { return count == 0 ? 0.0 : to_seconds(sum) / static_cast<double>(count); }
};

class LinkModel {
  public:
    // `key` names the study, experiment, subject and trial; `direction` tells the links of a session apart. The
    // random fate of packet n depends on (key, direction, n) only. The timeline counts from `start`, as do outages,
    // slots and traces by time; but slots do not begin before `opened`, when the first packet can come.
    LinkModel(const LinkSettings& settings, const StreamKey& key, std::uint32_t direction,
              const Timeline& timeline = {}, SessionTime start = SessionTime{},
              SessionTime opened = SessionTime{});

    // Forgets what is in flight and starts again at packet 0, with another key and the settings of the beginning (or
    // of the last change()): start of a trial.
    void restart(const StreamKey& key, SessionTime start = SessionTime{});

    // Changes the settings until the timeline changes them. Packets in flight keep their fate. Packets that wait for
    // the transmitter leave at the new rate. May allocate.
    void change(SessionTime now, const LinkSettings& settings);
    // Null: no observer (the default). Must outlive the model.
    void observe(LinkObserver* observer) { observer_ = observer; }

    // `traffic_class`: DSCP and ECN bits as they were received, which leave with the datagram.
    void push(SessionTime now, Bytes datagram, std::uint8_t traffic_class = 0);
    // The next datagram whose time has come, or an empty span; valid until the next push.
    Bytes pop_due(SessionTime now) {
        if (now < next_due_) return {};
        Packet* packet = take_first(now);
        return packet == nullptr ? Bytes{} : packet->bytes();
    }
    // As pop_due(), with the facts for a log.
    Departure pop_departure(SessionTime now);
    // As pop_due(), as a block with its head; null if none is due.
    Packet* pop_packet(SessionTime now) { return now < next_due_ ? nullptr : take_first(now); }
    // Removes any packet in flight and returns it, or null. Not counted; call it before restart() only.
    Packet* forget_any() {
        Packet* packet = line_.empty() ? transmitter_.take_any() : line_.take_first();
        if (packet != nullptr) store_.give_back(packet);
        return packet;
    }
    // True if a packet that is pushed now meets only a constant delay: its bytes do not matter.
    bool only_delays(SessionTime now) {
        if (now >= next_change_) run_until(now);
        return plain_ && in_flight_ < capacity_;
    }
    // True if a packet that is pushed now would leave now, before any other: it is counted as pushed and delivered, and needs no block.
    bool passes(SessionTime now) {
        if (!only_delays(now) || delay_ns_ != 0 || in_flight_ > 0) return false;
        count_delivered(counters_.pushed++, Duration{}, false);
        return true;
    }
    // The earliest time at which a packet can leave; with a transmitter perhaps none leaves then. kNever if nothing
    // is in flight.
    SessionTime next_due() const { return next_due_; }

    std::size_t in_flight() const { return in_flight_; }
    const LinkCounters& counters() const { return counters_; }
    const LinkDelays& delays() const { return delays_; }
    const LinkSettings& settings() const { return plans_[current_].settings; }  // those that hold now
    // Bytes reserved for packets; grows with the largest number in flight.
    std::size_t memory_bytes() const { return store_.reserved_bytes(); }

  private:
    struct Plan {
        Plan(Duration from, const LinkSettings& what);
        Duration at;
        LinkSettings settings;
        std::shared_ptr<const DelayShape> shape;
        bool plain;  // a constant delay and nothing else
    };

    void use(std::size_t plan, Duration time);
    void run_until(SessionTime now);
    void send_until(Duration time);
    void follow_timeline();
    struct Arrival {
        std::uint64_t packet;
        SessionTime now;
        Bytes datagram;
        std::uint8_t traffic_class;
    };
    void push_by_fate(const Arrival& arrival);
    void admit(const Arrival& arrival, const PacketFate& fate, bool copy);
    Packet* store(const Arrival& arrival);
    bool make_room(std::size_t bytes);
    void drop(const Arrival& arrival, DropReason reason);
    void forget_all();
    void update_next_due() {
        next_due_ = line_.next_due();
        if (!transmitter_.empty()) wait_for_transmitter();
    }
    void wait_for_transmitter();
    Packet* take_first(SessionTime now);  // null: nothing is due yet
    void count_delivered(std::uint64_t packet, Duration waited, bool copy) {
        delays_.sum += waited;
        delays_.min = std::min(delays_.min, waited);
        delays_.max = std::max(delays_.max, waited);
        ++delays_.count;
        ++counters_.delivered;
        if (packet >= latest_) {
            latest_ = packet;
        } else if (!copy) {
            ++counters_.reordered;
        }
    }

    std::vector<Plan> plans_;  // [0]: what holds at the start; then the timeline
    std::size_t current_ = 0;
    std::size_t next_plan_ = 1;
    SessionTime next_change_ = kNever;
    SessionTime start_{}, opened_{};
    std::uint32_t direction_;
    // Cached from the current settings, for packets with a constant delay only.
    bool plain_ = true;
    bool in_order_ = true;
    std::int64_t delay_ns_ = 0;
    std::size_t capacity_ = 0;

    LinkFates fates_;
    Transmitter transmitter_;
    DelayLine line_;
    PacketStore store_;
    SessionTime next_due_ = kNever;
    std::size_t in_flight_ = 0;
    std::uint64_t latest_ = 0;  // of those delivered
    LinkObserver* observer_ = nullptr;
    LinkCounters counters_;
    LinkDelays delays_;
};

}  // namespace thimble
