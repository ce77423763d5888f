// How late this machine's timer is when nothing else is asked of the program: the yardstick for anything that waits.
#pragma once

#include "common/histogram.hpp"

namespace thimble {

// Absolute deadlines, one each `period`, for `length`, by timerfd and epoll, in the calling thread as it is scheduled.
Histogram measure_timer(Duration period, Duration length);

}  // namespace thimble
