// A node with its channels and devices, still without a clock: the two loops (runtime/realtime_loop.hpp and
// session/virtual/virtual_loop.hpp) drive these same objects.
#pragma once

#include <algorithm>

#include <boost/core/noncopyable.hpp>

#include "common/messages.hpp"
#include "common/time.hpp"

namespace thimble {

inline constexpr Duration kHeartbeatPeriod = std::chrono::milliseconds{100};

// The times of a process's ticks. A process that stood still (SIGSTOP, or a machine without time for it) read no message
// meanwhile, and the others may have stood still as well. So of that time a heartbeat's period counts as silence, and each is
// heard again before it is given up.
class TickTimes {
  public:
    void tick(SessionTime now) {
        since_last_ = last_ == kNever ? Duration{} : now - last_;
        last_ = now;
    }
    Duration since_last() const { return since_last_; }
    // The part of that time in which no silence counts against a peer (InboundFlow::did_not_listen).
    Duration stood_still() const { return std::max(since_last_ - kHeartbeatPeriod, Duration{}); }

  private:
    SessionTime last_ = kNever;
    Duration since_last_{};
};

class Process : boost::noncopyable {
  public:
    virtual ~Process() = default;

    // Takes what has arrived, does what is due. Called at next_wakeup(), and whenever a datagram arrives on a
    // channel that wakes this process. Never blocks, never allocates after the first trial has started.
    virtual void tick(SessionTime now) = 0;

    // When tick must be called next if nothing arrives; kNever if only arrivals matter.
    virtual SessionTime next_wakeup() const = 0;

    // True when a shutdown was ordered and done.
    virtual bool stopped() const = 0;
};

}  // namespace thimble
