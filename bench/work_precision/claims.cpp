#include "bench/work_precision/claims.hpp"

#include <algorithm>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "bench/peers/cvode_tissue.hpp"
#include "bench/peers/odeint_tissue.hpp"
#include "bench/work_precision/tables.hpp"

namespace thimble {

namespace {

constexpr double kPositionClaim_m = 1e-13;
constexpr double kEventClaim_s = 1e-12;
constexpr double kAwakeClaim_ns = 60;
constexpr double kAsleepClaim_ns = 10;

std::vector<const Entry*> exact_on_smooth(const std::vector<Entry>& entries) {
    std::vector<const Entry*> list;
    for (const Entry& e : entries) {
        if (e.contestant.solver == kExactName && e.problem->kind == ProblemKind::kSmooth) list.push_back(&e);
    }
    return list;
}

// The greatest value over the smooth problems, and where.
SolverClaim worst_claim(const std::string& text, const std::string& unit, double limit,
                        const std::vector<const Entry*>& smooth, double (*value)(const Entry&)) {
    double worst = 0;
    std::string where = "none";
    bool all_ran = !smooth.empty();
    for (const Entry* e : smooth) {
        all_ran = all_ran && e->outcome == Outcome::kOk;
        if (value(*e) > worst) {
            worst = value(*e);
            where = e->problem->name;
        }
    }
    return {text, fmt::format("{:.2g} {} ({})", worst, unit, where), all_ran && worst <= limit};
}

// The least ratio over the smooth problems of the cheapest of `solvers` to `exact`, at equal error.
SolverClaim ratio_claim(const std::string& peer, std::span<const std::string_view> solvers, double at_least,
                        const std::vector<Entry>& entries) {
    double least = std::numeric_limits<double>::infinity();
    std::string where = "none";
    std::vector<double> ratios;
    unsigned unreached = 0;
    for (const Entry* exact : exact_on_smooth(entries)) {
        double peer_ns = std::numeric_limits<double>::infinity();
        for (const std::string_view solver : solvers) {
            const Entry* best = cheapest(entries, *exact->problem, solver, kEqualError_m);
            if (best != nullptr) peer_ns = std::min(peer_ns, best->cost.least_ns_per_ms);
        }
        const double ratio = peer_ns / exact->cost.least_ns_per_ms;
        if (ratio == std::numeric_limits<double>::infinity()) {
            ++unreached;
            continue;
        }
        ratios.push_back(ratio);
        if (ratio < least) {
            least = ratio;
            where = exact->problem->name;
        }
    }
    const std::string text = fmt::format("exact is {:g} x cheaper than {} at {:g} m on every smooth problem",
                                         at_least, peer, kEqualError_m);
    if (ratios.empty()) return {text, fmt::format("{} does not get there on any of them", peer), false};
    std::sort(ratios.begin(), ratios.end());
    return {text,
            fmt::format("{:.1f} x ({}), median {:.1f} x; on {} more {} does not get there", least, where,
                        ratios[ratios.size() / 2], unreached, peer),
            least >= at_least};
}

}  // namespace

std::vector<SolverClaim> judge_claims(const std::vector<Entry>& entries, double asleep_ns_per_step) {
    constexpr std::array<std::string_view, 4> kCvode{CvodeTissue::kAdamsName, CvodeTissue::kBdfName,
                                                     CvodeTissue::kAdamsGoesOnName,
                                                     CvodeTissue::kBdfGoesOnName};
    constexpr std::array<std::string_view, 1> kOdeint{OdeintTissue::kName};
    const auto smooth = exact_on_smooth(entries);
    return {
        worst_claim("exact: position error below 1e-13 m on every smooth problem", "m", kPositionClaim_m,
                    smooth, [](const Entry& e) { return e.accuracy.position_m; }),
        worst_claim("exact: event time error below 1e-12 s on every smooth problem", "s", kEventClaim_s,
                    smooth, [](const Entry& e) { return e.accuracy.event_time_s; }),
        worst_claim("exact: at most 60 ns per 1 ms step on every smooth problem", "ns", kAwakeClaim_ns,
                    smooth, [](const Entry& e) { return e.cost.least_ns_per_ms * e.problem->step_s * 1e3; }),
        {"a sleeping scene: at most 10 ns per step", fmt::format("{:.2g} ns", asleep_ns_per_step),
         asleep_ns_per_step <= kAsleepClaim_ns},
        ratio_claim("CVODE", kCvode, 50, entries),
        ratio_claim("odeint", kOdeint, 10, entries),
    };
}

std::string claims_table(const std::vector<SolverClaim>& claims) {
    std::string table;
    for (const SolverClaim& claim : claims) {
        table += fmt::format("{:<4} {}: {}\n", claim.holds ? "yes" : "no", claim.text, claim.measured);
    }
    return table;
}

}  // namespace thimble
