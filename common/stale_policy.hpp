// What an output does when its input falls silent: for `after` it goes on as the last input said, then it holds that, falls to
// zero within `ramp`, or is zero at once. A held output still ends with the trial, kPeerTimeout after the last input.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "common/config.hpp"
#include "common/time.hpp"

namespace thimble {

enum class StaleMode : std::uint8_t { kHold, kRamp, kZero };
inline constexpr std::array<std::string_view, 3> kStaleModeNames{"hold", "ramp", "zero"};
inline const char* to_string(StaleMode mode) {
    return kStaleModeNames[static_cast<std::size_t>(mode)].data();
}

struct StalePolicy {
    StaleMode mode = StaleMode::kZero;
    Duration after = std::chrono::milliseconds{100};
    Duration ramp = std::chrono::milliseconds{20};

    bool stale(Duration silence) const { return silence >= after; }
    // The share of the output that remains after this silence, 1 to 0.
    double share(Duration silence) const {
        if (!stale(silence) || mode == StaleMode::kHold) return 1;
        if (mode == StaleMode::kZero || ramp <= Duration::zero()) return 0;
        return std::max(0.0, 1 - to_seconds(silence - after) / to_seconds(ramp));
    }
    // "ramp to zero within 20 ms after 100 ms": for logs and reports.
    std::string text() const {
        const double after_ms = 1000 * to_seconds(after);
        if (mode == StaleMode::kHold) return fmt::format("hold after {:g} ms", after_ms);
        if (mode == StaleMode::kZero) return fmt::format("zero after {:g} ms", after_ms);
        return fmt::format("ramp to zero within {:g} ms after {:g} ms", 1000 * to_seconds(ramp), after_ms);
    }
};

// Keys stale ("hold", "ramp" or "zero"), stale_after_s and stale_ramp_s of a node's own table. Throws Error (usage).
inline StalePolicy read_stale_policy(const ConfigTable& table, StalePolicy defaults, Duration shortest,
                                     Duration longest) {
    StalePolicy policy = defaults;
    table.read("stale", policy.mode, kStaleModeNames,
               "Output when feedback stops. hold: keep the last value; ramp: reduce it to zero; zero: zero "
               "at once.");
    table.read("stale_after_s", policy.after, to_seconds(shortest), to_seconds(longest),
               "Time without feedback after which stale applies.");
    table.read("stale_ramp_s", policy.ramp, 0, 1, "ramp: time from the last value to zero.");
    if (table.has("stale_ramp_s") && policy.mode != StaleMode::kRamp) {
        table.fail("stale_ramp_s", "has an effect with stale = \"ramp\" only, and stale is \"{}\"",
                   to_string(policy.mode));
    }
    return policy;
}

// Refuses samples, one each [master] sample_period_s, that come after `node` has taken the last for stale. `effect` is for the
// message: "holds the needle before each sample". Throws Error (usage).
inline void require_fresh_samples(const ConfigFile& file, const char* node, Duration period,
                                  Duration stale_after,
                                  const char* effect = "lets each force go stale before the next") {
    if (period < stale_after) return;
    const bool own = file.table(node).has("stale_after_s");
    file.table(own ? node : "master")
        .fail(own ? "stale_after_s" : "sample_period_s",
              "{}: [master] sample_period_s is {:g}, [{}] stale_after_s {:g}; use a shorter period, or a "
              "longer stale_after_s",
              effect, to_seconds(period), node, to_seconds(stale_after));
}

}  // namespace thimble
