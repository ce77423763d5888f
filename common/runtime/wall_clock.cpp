#include "common/runtime/wall_clock.hpp"

#include <algorithm>
#include <ctime>
#include <random>
#include <sys/timerfd.h>
#include <thread>

namespace thimble {

namespace {

std::int64_t read_ns(clockid_t clock) {
    timespec now{};
    clock_gettime(clock, &now);
    return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

}  // namespace

SessionTime wall_now() { return from_nanoseconds(read_ns(CLOCK_MONOTONIC)); }

ClockPair read_clock_pair() {
    const SessionTime before = wall_now();
    const std::int64_t realtime_ns = read_ns(CLOCK_REALTIME);
    return {before, wall_now(), realtime_ns};
}

void set_timer(int timer, SessionTime when) {
    const std::int64_t ns = std::max<std::int64_t>(to_nanoseconds(when), 1);  // 0 would disarm
    itimerspec value{};
    value.it_value.tv_sec = ns / 1'000'000'000;
    value.it_value.tv_nsec = ns % 1'000'000'000;
    timerfd_settime(timer, TFD_TIMER_ABSTIME, &value, nullptr);
}

void wall_sleep(Duration duration) { std::this_thread::sleep_for(duration); }

std::uint64_t system_entropy() {
    std::random_device device;
    return (std::uint64_t{device()} << 32) | device();
}

}  // namespace thimble
