// A node with its channels and devices, still without a clock: the two loops (runtime/realtime_loop.hpp and
// session/virtual/virtual_loop.hpp) drive these same objects.
#pragma once

#include <boost/core/noncopyable.hpp>

#include "common/messages.hpp"
#include "common/time.hpp"

namespace thimble {

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
