#include "common/runtime/timer_probe.hpp"

#include <array>

#include "common/runtime/event_waiter.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {

Histogram measure_timer(Duration period, Duration length) {
    Histogram lateness;
    EventWaiter waiter(false);
    std::array<epoll_event, 1> room{};
    const SessionTime end = wall_now() + length;
    for (SessionTime due = wall_now() + period; due < end;) {
        waiter.wait(due, due, room);
        const SessionTime now = wall_now();
        if (now < due) continue;  // a signal
        lateness.add(now - due);
        due += period * ((now - due) / period + 1);  // what a stall has swallowed is one lateness, not many
    }
    return lateness;
}

}  // namespace thimble
