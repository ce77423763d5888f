#include "thimble/link_test/verdict.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace thimble {
namespace {

constexpr double kLossMarginal = 0.05, kLossTooMuch = 0.5;

struct Finding {
    Fit fit;
    std::string reason;
};

std::string in_ms(double seconds) {
    return std::isinf(seconds) ? "any" : fmt::format("{:.3g} ms", 1000 * seconds);
}

Finding judge_stability(const LoopFigures& link, const LoopLimits& limits) {
    const double hold_s = limits.sample_period_s / 2;
    const double median_s = link.round_trip_median_s + hold_s, p99_s = link.round_trip_p99_s + hold_s;
    const std::string limit = in_ms(limits.critical_delay_s);
    if (p99_s <= limits.critical_delay_s) {
        return {Fit::kFits,
                fmt::format("loop delay {} (p99 {}), stable below {}", in_ms(median_s), in_ms(p99_s), limit)};
    }
    if (median_s <= limits.critical_delay_s) {
        return {Fit::kMarginal,
                fmt::format("loop delay {} is stable, but its p99 {} is above the critical {}",
                            in_ms(median_s), in_ms(p99_s), limit)};
    }
    return {Fit::kDoesNotFit, fmt::format("loop delay {} is above the critical {}: contact oscillates",
                                          in_ms(median_s), limit)};
}

Finding judge_depth(Modality modality, const LoopFigures& link, const LoopLimits& limits) {
    const double own_s = limits.latency_s[static_cast<std::size_t>(modality)];
    const double share = link.round_trip_p99_s / own_s;
    const std::string words =
        fmt::format("p99 {} on top of the modality's own {}: the needle runs on {:.0f} % further",
                    in_ms(link.round_trip_p99_s), in_ms(own_s), 100 * share);
    if (share <= 0.5) return {Fit::kFits, words};
    return {share <= 1 ? Fit::kMarginal : Fit::kDoesNotFit, words};
}

Finding judge_pauses(const LoopFigures& link, const LoopLimits& limits) {
    if (link.longest_gap_s > limits.released_s) {
        return {Fit::kDoesNotFit, fmt::format("a pause of {}: after {} every display lets go",
                                              in_ms(link.longest_gap_s), in_ms(limits.released_s))};
    }
    if (link.longest_gap_s > limits.needle_held_s) {
        return {Fit::kMarginal,
                fmt::format("a pause of {}: after {} the needle is held and contact starts anew",
                            in_ms(link.longest_gap_s), in_ms(limits.needle_held_s))};
    }
    return {Fit::kFits, ""};
}

// Only the force at the handle has a known age.
Finding judge_age(const LoopFigures& link, const LoopLimits& limits) {
    if (link.round_trip_p99_s <= limits.late_s) return {Fit::kFits, ""};
    const bool mostly = link.round_trip_median_s > limits.late_s;
    return {
        mostly ? Fit::kDoesNotFit : Fit::kMarginal,
        fmt::format(
            "{} forces are more than {} late and count as none, unless [master] oldest_force_s says {:.2g}",
            mostly ? "most" : "some", in_ms(limits.late_s),
            limits.configured_s + 1.2 * link.round_trip_p99_s)};
}

Finding judge_loss(const LoopFigures& link) {
    const std::string words = fmt::format("{:.1f} % of the samples lost", 100 * link.loss);
    if (link.loss >= kLossTooMuch) return {Fit::kDoesNotFit, words};
    return {link.loss > kLossMarginal ? Fit::kMarginal : Fit::kFits, words};
}

}  // namespace

const char* to_string(Fit fit) {
    static constexpr std::array kNames{"fits", "marginal", "does not fit"};
    return kNames[static_cast<std::size_t>(fit)];
}

ModalityVerdict judge(Modality modality, const LoopFigures& link, const LoopLimits& limits) {
    const Finding delay =
        modality == Modality::kHF ? judge_stability(link, limits) : judge_depth(modality, link, limits);
    ModalityVerdict verdict{modality, delay.fit, delay.reason};
    const Finding age = modality == Modality::kHF ? judge_age(link, limits) : Finding{Fit::kFits, ""};
    for (const Finding& finding : {age, judge_pauses(link, limits), judge_loss(link)}) {
        if (finding.fit == Fit::kFits) continue;
        verdict.fit = std::max(verdict.fit, finding.fit);
        verdict.reason += "; " + finding.reason;
    }
    return verdict;
}

std::vector<ModalityVerdict> judge_all(const std::vector<Modality>& modalities, const LinkFigures& link,
                                       const LoopLimits& limits) {
    const LoopFigures loop = loop_figures(link);
    std::vector<ModalityVerdict> verdicts;
    if (!loop.measured) return verdicts;
    for (const Modality modality : modalities) verdicts.push_back(judge(modality, loop, limits));
    return verdicts;
}

}  // namespace thimble
