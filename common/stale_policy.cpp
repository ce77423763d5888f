#include "common/stale_policy.hpp"

#include <fmt/format.h>

namespace thimble {

const char* to_string(StaleMode mode) { return kStaleModeNames[static_cast<std::size_t>(mode)].data(); }

std::string StalePolicy::text() const {
    const double after_ms = 1000 * to_seconds(after);
    if (mode == StaleMode::kHold) return fmt::format("hold after {:g} ms", after_ms);
    if (mode == StaleMode::kZero) return fmt::format("zero after {:g} ms", after_ms);
    return fmt::format("ramp to zero within {:g} ms after {:g} ms", 1000 * to_seconds(ramp), after_ms);
}

StalePolicy read_stale_policy(const ConfigTable& table, StalePolicy defaults, Duration shortest,
                              Duration longest) {
    StalePolicy policy = defaults;
    table.read(
        "stale", policy.mode, kStaleModeNames,
        "Without feedback keep the last output (hold), let it fall (ramp), or have none at once (zero).");
    table.read("stale_after_s", policy.after, to_seconds(shortest), to_seconds(longest),
               "Without feedback for so long the output does what stale says.");
    table.read("stale_ramp_s", policy.ramp, 0, 1, "ramp: how long the output takes to fall.");
    if (table.has("stale_ramp_s") && policy.mode != StaleMode::kRamp) {
        table.fail("stale_ramp_s", "is of stale = \"ramp\" only, and stale is \"{}\"",
                   to_string(policy.mode));
    }
    return policy;
}

}  // namespace thimble
