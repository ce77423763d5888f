// The one thing in Thimble that delays: a passive, seeded queue for one direction of one flow. Time is an
// argument; the relay process uses it in real time and the virtual loop in virtual time, with the same fate
// for each packet.
#pragma once

#include <array>
#include <cassert>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/channel.hpp"
#include "common/random.hpp"
#include "common/time.hpp"
#include "netem/link_observer.hpp"
#include "netem/link_settings.hpp"

namespace thimble {

// Since the last restart.
//   pushed + duplicated = lost + outage + oversized + queue_full + overflowed + delivered + in flight
struct LinkCounters {
    std::uint64_t pushed = 0;
    std::uint64_t lost = 0, outage = 0, oversized = 0, queue_full = 0, overflowed = 0;  // as in DropReason
    std::uint64_t delivered = 0;
    std::uint64_t duplicated = 0;  // second copies made
    std::uint64_t corrupted = 0;   // pushed packets of which bits were flipped
    std::uint64_t skipped = 0;     // packets that the reorder stage let go without delay
    std::uint64_t reordered = 0;   // delivered after a later one (RFC 4737)

    LinkCounters& operator+=(const LinkCounters& other);
};

// What the delivered packets really waited, from push to pop, since the last restart.
struct LinkDelays {
    Duration sum{};
    Duration min = Duration::max();  // as long as count is 0
    Duration max{};
    std::uint64_t count = 0;

    double mean_s() const { return count == 0 ? 0.0 : to_seconds(sum) / static_cast<double>(count); }
};

class LinkModel {
  public:
    // `key` names the study, experiment, subject and trial; `direction` tells the links of a session apart.
    // The fate of packet n depends on (key, direction, n) only.
    LinkModel(const LinkSettings& settings, const StreamKey& key, std::uint32_t direction);

    // Forgets what is in flight and starts again at packet 0 with another key (start of a trial). Outages, slots,
    // traces by time and the timeline count from `start`.
    void restart(const StreamKey& key, SessionTime start = SessionTime{});

    // From now on other settings. What is in flight keeps its fate; fates stay keyed by packet number.
    void change(SessionTime now, const LinkSettings& settings);
    // Null: nobody (the default). Must outlive the model.
    void observe(LinkObserver* observer) { observer_ = observer; }

    void push(SessionTime now, Bytes datagram);
    // The next datagram whose time has come, or an empty span; valid until the next push.
    Bytes pop_due(SessionTime now) { return now < next_due_ ? Bytes{} : take_first(now).bytes; }
    // The same with what a log wants to know.
    Departure pop_departure(SessionTime now) { return now < next_due_ ? Departure{} : take_first(now); }
    // kNever if nothing is in flight.
    SessionTime next_due() const { return next_due_; }

    std::size_t in_flight() const { return in_flight_; }
    const LinkCounters& counters() const { return counters_; }
    const LinkDelays& delays() const { return delays_; }
    const LinkSettings& settings() const { return settings_; }

  private:
    // Plain integers instead of time points: an array of these is left untouched until it is used, so that a
    // large capacity costs no memory that was never needed.
    struct alignas(64) Slot {
        std::int64_t due_ns;
        std::int64_t pushed_ns;
        std::uint64_t packet;
        std::uint32_t next;  // in the queue or in the chain of free slots
        std::uint32_t size;
        std::array<std::uint8_t, kMaxDatagramBytes> bytes;
    };
    struct Waiting {
        std::int64_t due_ns;
        std::uint64_t packet;
        std::uint32_t slot;
    };
    // For std::push_heap: true if `a` leaves after `b`. Never equal, so the order is the same everywhere.
    static bool leaves_later(const Waiting& a, const Waiting& b) {
        return a.due_ns != b.due_ns ? a.due_ns > b.due_ns : a.packet > b.packet;
    }

    StreamKey stream_key(const StreamKey& key, Purpose purpose) const;
    std::int64_t draw_delay_ns(std::uint64_t packet);
    std::uint32_t take_free_slot();
    void append(std::uint32_t slot);
    void insert(std::uint32_t slot, std::uint64_t packet);
    std::uint32_t remove_first();
    void drop(std::uint64_t packet, SessionTime now, DropReason reason);
    Departure take_first(SessionTime now);

    LinkSettings settings_;
    std::uint32_t direction_;
    RandomStream delay_stream_;
    RandomStream loss_stream_;
    std::unique_ptr<Slot[]> slots_;
    std::vector<Waiting> heap_;  // only if packets may overtake each other
    SessionTime next_due_ = kNever;
    std::int64_t last_due_ns_ = INT64_MIN;
    std::size_t in_flight_ = 0;
    // The slot freed last is used first: the working set is what is in flight, not the capacity.
    std::uint32_t free_ = 0;
    std::uint32_t unused_ = 0;  // slots from here on were never used
    std::uint32_t head_ = 0;    // in order: chain from head_ to tail_, meaningless if nothing is in flight
    std::uint32_t tail_ = 0;
    LinkObserver* observer_ = nullptr;
    LinkCounters counters_;
    LinkDelays delays_;
};

}  // namespace thimble
