// Waits for descriptors and for a moment. Frugal: an absolute timer. Precise: the timer wakes early by a margin that
// follows its own lateness, and the rest is spun away, looking at the descriptors meanwhile. Precise waiting needs
// SCHED_FIFO; under the default scheduler a spinner is what gets preempted.
#pragma once

#include <cstdint>
#include <span>
#include <sys/epoll.h>

#include <boost/core/noncopyable.hpp>

#include "common/histogram.hpp"
#include "common/runtime/wait_margin.hpp"
#include "common/text_file.hpp"
#include "common/time.hpp"

namespace thimble {

struct WaitCounters {
    std::uint64_t waits = 0;      // that slept
    std::uint64_t spins = 0;      // that ended in spinning
    std::uint64_t exhausted = 0;  // deadlines slept for because the budget for spinning was used up
    Duration spun{};
};

class EventWaiter : boost::noncopyable {
  public:
    // Throws Error (network), as sockets do, if the kernel refuses a timer: no descriptor is free.
    explicit EventWaiter(bool precise);

    // `tag` comes back in event.data.u64; UINT64_MAX is taken. False if the kernel refuses.
    bool add(int descriptor, std::uint64_t tag);
    void remove(int descriptor);

    // Until a descriptor is readable, `due` (to be met precisely) or `latest` (not) has come, or a signal. Returns the
    // events of descriptors.
    std::span<const epoll_event> wait(SessionTime due, SessionTime latest, std::span<epoll_event> room);

    bool precise() const { return precise_; }
    Duration margin() const { return margin_.margin(); }
    const WaitCounters& counters() const { return counters_; }

  private:
    std::span<const epoll_event> poll(int timeout_ms, std::span<epoll_event> room);
    std::span<const epoll_event> sleep_until(SessionTime when, std::span<epoll_event> room);
    std::span<const epoll_event> spin_until(SessionTime due, SessionTime now, std::span<epoll_event> room);
    void arm(SessionTime when);

    FileDescriptor epoll_, timer_;
    bool precise_;
    SessionTime armed_ = kNever;
    WaitMargin margin_;
    SpinBudget budget_;
    WaitCounters counters_;
};

// Measures the lateness of this machine's timer: absolute deadlines, one each `period`, for `length`, by timerfd and
// epoll, in the calling thread as it is scheduled. A baseline for the loops.
Histogram measure_timer(Duration period, Duration length);

}  // namespace thimble
