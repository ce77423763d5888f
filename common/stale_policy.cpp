#include "common/stale_policy.hpp"

#include <fmt/format.h>

namespace thimble {

const char* to_string(StaleMode mode) {
    switch (mode) {
        case StaleMode::kHold:
            return "hold";
        case StaleMode::kRamp:
            return "ramp";
        case StaleMode::kZero:
            return "zero";
    }
    return "?";
}

std::string StalePolicy::text() const {
    const double after_ms = 1000 * to_seconds(after);
    if (mode == StaleMode::kHold) return fmt::format("hold after {:g} ms", after_ms);
    if (mode == StaleMode::kZero) return fmt::format("zero after {:g} ms", after_ms);
    return fmt::format("ramp to zero within {:g} ms after {:g} ms", 1000 * to_seconds(ramp), after_ms);
}

StalePolicy read_stale_policy(const ConfigTable& table, StalePolicy defaults, Duration shortest,
                              Duration longest) {
    StalePolicy policy = defaults;
    policy.mode = static_cast<StaleMode>(
        table.choice("stale", static_cast<std::size_t>(defaults.mode), {"hold", "ramp", "zero"}));
    policy.after = table.seconds("stale_after_s", defaults.after, shortest, longest);
    policy.ramp = table.seconds("stale_ramp_s", defaults.ramp, Duration::zero(), std::chrono::seconds{1});
    if (table.has("stale_ramp_s") && policy.mode != StaleMode::kRamp) {
        table.fail("stale_ramp_s",
                   fmt::format("is of stale = \"ramp\" only, and stale is \"{}\"", to_string(policy.mode)));
    }
    return policy;
}

}  // namespace thimble
