#include "common/runtime/event_waiter.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <sys/timerfd.h>

#include "common/error.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {

namespace {

constexpr std::uint64_t kTimerTag = UINT64_MAX;
// Looking at the descriptors is a system call: now and then while there is time, not at all at the very end.
constexpr Duration kLookEvery = std::chrono::microseconds{3};

}  // namespace

EventWaiter::EventWaiter(bool precise)
    : epoll_(epoll_create1(EPOLL_CLOEXEC)),
      timer_(timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC)),
      precise_(precise) {
    if (epoll_.get() < 0 || timer_.get() < 0 || !add(timer_.get(), kTimerTag)) {
        throw Error(ExitCode::kNetwork, "cannot make a timer: {}{}", std::strerror(errno),
                    descriptor_advice(errno));
    }
}

bool EventWaiter::add(int descriptor, std::uint64_t tag) {
    epoll_event event{};
    event.events = EPOLLIN;
    event.data.u64 = tag;
    return epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, descriptor, &event) == 0;
}

void EventWaiter::remove(int descriptor) { epoll_ctl(epoll_.get(), EPOLL_CTL_DEL, descriptor, nullptr); }

void EventWaiter::arm(SessionTime when) {
    if (when == armed_) return;
    armed_ = when;
    set_timer(timer_.get(), when);
}

// A timer that has fired stays readable until it is armed anew: arm() does so for every new moment.
std::span<const epoll_event> EventWaiter::poll(int timeout_ms, std::span<epoll_event> room) {
    const int found = epoll_wait(epoll_.get(), room.data(), static_cast<int>(room.size()), timeout_ms);
    if (found <= 0) return {};
    const auto end = std::remove_if(room.begin(), room.begin() + found,
                                    [](const epoll_event& event) { return event.data.u64 == kTimerTag; });
    if (end != room.begin() + found) armed_ = kNever;
    return room.first(static_cast<std::size_t>(end - room.begin()));
}

std::span<const epoll_event> EventWaiter::sleep_until(SessionTime when, std::span<epoll_event> room) {
    ++counters_.waits;
    arm(when);
    return poll(-1, room);
}

std::span<const epoll_event> EventWaiter::wait(SessionTime due, SessionTime latest,
                                               std::span<epoll_event> room) {
    const SessionTime now = wall_now();
    if (std::min(due, latest) <= now) return poll(0, room);
    if (!precise_ || due > latest) return sleep_until(std::min(due, latest), room);
    if (budget_.left(now) <= Duration::zero()) {
        ++counters_.exhausted;
        return sleep_until(due, room);
    }
    const SessionTime early = due - margin();
    if (early <= now) return spin_until(due, now, room);
    const auto events = sleep_until(early, room);
    const SessionTime woken = wall_now();
    if (woken < early) return events;  // by a descriptor or a signal
    margin_.add(woken - early);
    return events.empty() ? spin_until(due, woken, room) : events;
}

std::span<const epoll_event> EventWaiter::spin_until(SessionTime due, SessionTime now,
                                                     std::span<epoll_event> room) {
    ++counters_.spins;
    const SessionTime start = now;
    const SessionTime end = std::min(due, now + budget_.left(now));
    SessionTime look = now + kLookEvery;
    std::span<const epoll_event> events;
    while (events.empty() && now < end) {
        if (now >= look && end - now > kLookEvery) {
            events = poll(0, room);
            look = now + kLookEvery;
        }
        now = wall_now();
    }
    counters_.spun += now - start;
    budget_.spent(now, now - start);
    return events;
}

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
