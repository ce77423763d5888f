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

// Slots that have passed need not all be counted one by one. Never goes to a slot after `time`.
void Slots::jump_towards(Duration time) {
    if (time <= next_opens_) return;
    if (settings_.least == settings_.most) {
        const std::int64_t missed = (time - next_opens_) / settings_.least;
        slot_ += static_cast<std::uint64_t>(missed);
        next_opens_ += missed * settings_.least;
    } else {
        while (jump_over_many(time)) {
        }
    }
}

// The sum of n thousand uniform gaps is normal. n is so small that even eight standard deviations end before `time`.
bool Slots::jump_over_many(Duration time) {
    const auto least_ns = static_cast<double>(settings_.least.count());
    const double width_ns = static_cast<double>(settings_.most.count()) - least_ns;
    const double mean_ns = least_ns + width_ns / 2;
    const double deviation_ns = width_ns / std::sqrt(12.0);
    const auto left_ns = static_cast<double>((time - next_opens_).count());
    if (left_ns <= static_cast<double>(kMostSteps) * mean_ns) return false;
    // n mean + 8 deviation sqrt(n) = left, solved for sqrt(n).
    const double half = 4 * deviation_ns / mean_ns;
    const double root = std::sqrt(half * half + left_ns / mean_ns) - half;
    const double n = std::floor(root * root);
    const double sum_ns = n * mean_ns + std::sqrt(n) * deviation_ns * numbers_.normal(slot_);
    slot_ += static_cast<std::uint64_t>(n);
    next_opens_ += Duration{std::llround(std::clamp(sum_ns, n * least_ns, left_ns))};
    return true;
}

bool Slots::is_full(std::size_t bytes) const {
    if (settings_.packets > 0 && packets_ >= settings_.packets) return true;
    return settings_.bytes > 0 && packets_ > 0 && bytes_ + bytes > settings_.bytes;
}

Duration Slots::opening(Duration arrival, Duration free_at, std::size_t bytes) {
    jump_towards(std::max(arrival, free_at));
    while (opens_ < arrival || is_full(bytes) || next_opens_ <= free_at) advance();
    return std::max(opens_, free_at);
}

void Slots::take(std::size_t bytes) {
    ++packets_;
    bytes_ += bytes;
}

bool is_out(const std::vector<Outage>& outages, Duration time) {
    return std::any_of(outages.begin(), outages.end(), [&](const Outage& outage) {
        if (time < outage.start) return false;
        const Duration since = time - outage.start;
        return (outage.every > Duration::zero() ? since % outage.every : since) < outage.length;
    });
}

}  // namespace thimble
