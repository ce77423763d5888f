#include "netem/stages/slots.hpp"

#include <algorithm>
#include <cmath>

namespace thimble {

void Slots::configure(const SlotSettings& settings, Duration now) {
    if (settings == settings_) return;
    settings_ = settings;
    if (!active()) return;
    opens_ = next_opens_ = now;
    advance();
}

void Slots::advance() {
    const double width_ns = static_cast<double>((settings_.most - settings_.least).count());
    const Duration gap = settings_.least + Duration{std::llround(numbers_.uniform(slot_++) * width_ns)};
    opens_ = next_opens_;
    next_opens_ += std::max(gap, Duration{1});
    packets_ = bytes_ = 0;
}

// Slots at equal distances need not be counted one by one.
void Slots::jump_to(Duration arrival) {
    if (settings_.least != settings_.most || arrival <= next_opens_) return;
    const std::int64_t missed = (arrival - next_opens_) / settings_.least;
    slot_ += static_cast<std::uint64_t>(missed);
    next_opens_ += missed * settings_.least;
}

bool Slots::is_full(std::size_t bytes) const {
    if (settings_.packets > 0 && packets_ >= settings_.packets) return true;
    return settings_.bytes > 0 && packets_ > 0 && bytes_ + bytes > settings_.bytes;
}

Duration Slots::opening(Duration arrival, Duration free_at, std::size_t bytes) {
    jump_to(arrival);
    while (opens_ < arrival || is_full(bytes) || next_opens_ <= free_at) advance();
    return std::max(opens_, free_at);
}

void Slots::take(std::size_t bytes) {
    ++packets_;
    bytes_ += bytes;
}

}  // namespace thimble
