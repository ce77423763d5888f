#include "common/runtime/wall_clock.hpp"

#include <ctime>
#include <random>
#include <thread>

namespace thimble {

SessionTime wall_now() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return from_nanoseconds(std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec);
}

void wall_sleep(Duration duration) { std::this_thread::sleep_for(duration); }

std::uint64_t system_entropy() {
    std::random_device device;
    return (std::uint64_t{device()} << 32) | device();
}

}  // namespace thimble
