// A medium that sends in bursts: slots open at instants, and each takes what waits then, up to its limits. The first
// opens at the start of the trial (or when slots are switched on), and the time from slot k to the next is drawn by
// k: the grid does not depend on the traffic. (netem draws it when a packet finds the last slot over.) A pause of more
// than kMostSteps slots keeps the distribution of the grid. Its instants then depend on when the pause ended.
// Uniform slots draw their k-th number, other shapes (netem's "slot distribution") their k-th deviate.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/math/portable.hpp"
#include "netem/link_settings.hpp"
#include "netem/stages/jitter.hpp"
#include "netem/stages/packet_numbers.hpp"

namespace thimble {

class Slots {
  public:
    // The model counts at most this many unused slots one by one, so that one packet never takes long.
    static constexpr std::int64_t kMostSteps = 8192;

    Slots(const StreamKey& key, std::uint32_t direction)
        : numbers_(link_key(key, direction, Purpose::kLinkSlot)),
          deviates_(link_key(key, direction, Purpose::kLinkSlot)) {}

    void configure(const SlotSettings& settings, Duration now) {
        if (settings == settings_) return;
        settings_ = settings;
        if (!active()) return;
        measure_gaps();
        opens_ = next_opens_ = now;
        advance();
    }

    bool active() const { return settings_.most > Duration::zero(); }

    // When a packet that came at `arrival` may go, if the medium is taken until `free_at`: with the slot that is open
    // then if it came before that opened, or with a later one. Never goes back; asking twice changes nothing.
    Duration opening(Duration arrival, Duration free_at, std::size_t bytes) {
        jump_towards(std::max(arrival, free_at));
        while (opens_ < arrival || is_full(bytes) || next_opens_ <= free_at) advance();
        return std::max(opens_, free_at);
    }

    // It goes with that slot.
    void take(std::size_t bytes) {
        ++packets_;
        bytes_ += bytes;
    }

  private:
    bool is_full(std::size_t bytes) const {
        if (settings_.packets > 0 && packets_ >= settings_.packets) return true;
        return settings_.bytes > 0 && packets_ > 0 && bytes_ + bytes > settings_.bytes;
    }

    void advance() {
        const Duration gap = uniform() ? uniform_gap() : shaped_gap(deviates_.deviate(slot_));
        ++slot_;
        opens_ = next_opens_;
        next_opens_ += std::max(gap, Duration{1});
        packets_ = bytes_ = 0;
    }

    bool uniform() const { return settings_.shape == JitterShape::kUniform; }
    Duration uniform_gap() {
        const double width_ns = static_cast<double>((settings_.most - settings_.least).count());
        return settings_.least + Duration{std::llround(numbers_.uniform(slot_) * width_ns)};
    }
    Duration shaped_gap(double deviate) const {
        const Duration spread = (settings_.most - settings_.least) / 2;
        const double offset_ns = deviate * static_cast<double>(spread.count());
        return std::max(Duration::zero(), settings_.least + spread + Duration{std::llround(offset_ns)});
    }

    // Mean and standard deviation of the time between two slots. Of a shape that is cut at 0 only a sum over it tells.
    void measure_gaps() {
        least_ns_ = uniform() ? static_cast<double>(settings_.least.count()) : 1;
        const double width_ns = static_cast<double>((settings_.most - settings_.least).count());
        mean_ns_ = static_cast<double>(settings_.least.count()) + width_ns / 2;
        deviation_ns_ = width_ns / std::sqrt(12.0);
        if (uniform()) return;
        const auto shape = std::make_shared<const DelayShape>(
            JitterSettings{.shape = settings_.shape, .table = settings_.table}, Duration::zero());
        deviates_.configure(shape, 0);
        double weights = 0, sum_ns = 0, squares_ns2 = 0;
        for (int i = -kQuantiles; i <= kQuantiles; ++i) {
            const double z = kReach * i / kQuantiles, weight = portable::exp(-z * z / 2);
            const auto gap_ns = static_cast<double>(shaped_gap(shape->at_normal(z)).count());
            weights += weight;
            sum_ns += weight * gap_ns;
            squares_ns2 += weight * gap_ns * gap_ns;
        }
        mean_ns_ = std::max(1.0, sum_ns / weights);
        deviation_ns_ = std::sqrt(std::max(0.0, squares_ns2 / weights - mean_ns_ * mean_ns_));
    }

    // Slots that have passed need not all be counted one by one. Never goes to a slot after `time`.
    void jump_towards(Duration time) {
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

    // The sum of n thousand gaps is normal. n is so small that even eight standard deviations end before `time`.
    bool jump_over_many(Duration time) {
        const auto left_ns = static_cast<double>((time - next_opens_).count());
        if (left_ns <= static_cast<double>(kMostSteps) * mean_ns_) return false;
        // n mean + 8 deviation sqrt(n) = left, solved for sqrt(n).
        const double half = 4 * deviation_ns_ / mean_ns_;
        const double root = std::sqrt(half * half + left_ns / mean_ns_) - half;
        const double n = std::floor(root * root);
        const double sum_ns =
            n * mean_ns_ + std::sqrt(n) * deviation_ns_ * numbers_.normal(uniform() ? slot_ : slot_ | kApart);
        slot_ += static_cast<std::uint64_t>(n);
        next_opens_ += Duration{std::llround(std::clamp(sum_ns, n * least_ns_, left_ns))};
        return true;
    }

    static constexpr int kQuantiles = 500;
    static constexpr double kReach = 8;
    static constexpr std::uint64_t kApart = std::uint64_t{1} << 62;  // numbers that no deviate takes

    PacketNumbers numbers_;
    Jitter deviates_;
    double least_ns_ = 0, mean_ns_ = 1, deviation_ns_ = 0;
    SlotSettings settings_{};
    std::uint64_t slot_ = 0;
    Duration opens_{}, next_opens_{};
    std::size_t packets_ = 0, bytes_ = 0;  // gone with this slot
};

// When nothing gets through. Packets that are on their way still arrive.

// `time` since the start of the trial. An outage holds from its start until just before its end.
inline bool is_out(const std::vector<Outage>& outages, Duration time) {
    return std::any_of(outages.begin(), outages.end(), [&](const Outage& outage) {
        if (time < outage.start) return false;
        const Duration since = time - outage.start;
        return (outage.every > Duration::zero() ? since % outage.every : since) < outage.length;
    });
}

}  // namespace thimble
