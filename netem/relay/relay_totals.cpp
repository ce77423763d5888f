#include "netem/relay/relay_totals.hpp"

#include <algorithm>
#include <cmath>

namespace thimble {

ProportionInterval wilson_95(std::uint64_t successes, std::uint64_t trials) {
    if (trials == 0) return {};
    constexpr double kZ = 1.959963984540054;  // normal quantile of 0.975
    const auto n = static_cast<double>(trials);
    const double p = static_cast<double>(successes) / n;
    const double shrink = 1 + kZ * kZ / n;
    const double centre = (p + kZ * kZ / (2 * n)) / shrink;
    const double half = kZ / shrink * std::sqrt(p * (1 - p) / n + kZ * kZ / (4 * n * n));
    return {successes == 0 ? 0.0 : std::max(0.0, centre - half),
            successes == trials ? 1.0 : std::min(1.0, centre + half)};
}

AchievedLoss achieved_loss(const LinkCounters& packets) {
    return {packets.lost, packets.pushed - packets.oversized - packets.outage};
}

}  // namespace thimble
