// Statements of abstract, discussion and text that have no test of their own.
#include <array>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "analysis/claims/claim_findings.hpp"
#include "analysis/statistics/descriptive.hpp"
#include "analysis/statistics/equivalence.hpp"
#include "analysis/statistics/pairwise.hpp"
#include "common/error.hpp"

namespace thimble {
namespace {

// Study, subject and trial of each.
std::set<std::array<std::uint64_t, 3>> trials_with_cf(const StudyColumns& columns) {
    std::set<std::array<std::uint64_t, 3>> trials;
    for (const TrialRow& row : columns.rows()) {
        const TrialConditions& c = row.conditions;
        if (c.modality == Modality::kCF) trials.insert({c.study_seed, c.subject, c.trial});
    }
    return trials;
}

// Of all trials of a subject, averaged over subjects.
double session_s(const StudyColumns& columns) {
    double sum_s = 0;
    for (const TrialRow& row : columns.rows()) sum_s += row.metrics.duration_s;
    if (std::isnan(sum_s)) throw Error(ExitCode::kData, "a trial's duration is missing");
    return sum_s / static_cast<double>(columns.subjects().size());
}

// Throws Error (data) if subjects differ in their number of trials: the length of an unfinished session is unknown.
double trials_per_subject(const StudyColumns& columns) {
    std::map<std::uint32_t, std::size_t> trials;
    for (const TrialRow& row : columns.rows()) ++trials[row.conditions.subject];
    for (const auto& [subject, count] : trials) {
        if (count == trials.begin()->second) continue;
        throw Error(ExitCode::kData, fmt::format("subject {} has another number of trials than subject {}",
                                                 subject, trials.begin()->first));
    }
    return static_cast<double>(trials.begin()->second);
}

}  // namespace

// Differences that would not matter, stated before any data: a twentieth of the way to the fixture, a tenth of the time.
Finding indistinct_finding(const StudyColumns& columns) {
    constexpr double kBound_m = 0.05 * 0.123;
    const SampleTable depth = columns.table(Metric::kPenetrationMean).table;
    const SampleTable time = columns.table(Metric::kCompletionTime).table;
    const double bound_s = 0.1 * sample_mean(time.column(0));
    const Equivalence of_depth = equivalence(depth.column(1), depth.column(0), {-kBound_m, kBound_m});
    const Equivalence of_time = equivalence(time.column(1), time.column(0), {-bound_s, bound_s});
    return {
        fmt::format("CF - HF: mean penetration {:.2f} mm, 90 % interval {:.2f} to {:.2f}, within +-{:.2f} mm "
                    "(5 % of the depth) {}; time {:.2f} s, {:.2f} to {:.2f}, within +-{:.2f} s (10 %) {}",
                    1e3 * of_depth.difference, 1e3 * of_depth.interval.low, 1e3 * of_depth.interval.high,
                    1e3 * kBound_m, p_text(of_depth.p()), of_time.difference, of_time.interval.low,
                    of_time.interval.high, bound_s, p_text(of_time.p())),
        of_depth.p() < 0.05 && of_time.p() < 0.05};
}

// The same people, the same trials, only the lag gone: what is left of CF's distance to HF is not the lag's.
Finding lag_finding(const StudyColumns& one, const StudyColumns& no_lag) {
    if (trials_with_cf(one) != trials_with_cf(no_lag)) {
        throw Error(ExitCode::kData, "not the same trials with and without the actuators' lag");
    }
    const auto metric = Metric::kPenetrationMean;
    NamedValues with = one.column(metric, Modality::kCF), without = no_lag.column(metric, Modality::kCF);
    with.name = "CF";
    without.name = "CF without lag";
    const SampleTable table = complete_rows({one.column(metric, Modality::kHF), with, without}).table;
    const double cost_m = sample_mean(table.column(1)) - sample_mean(table.column(0));
    const MeanPair lag =
        paired_t_tests(SampleTable::from_columns({table.column(1), table.column(2)})).pairs.front();
    const bool costs = lag.difference > 0;
    return {fmt::format(
                "{}; of the {:.2f} mm from HF to CF the lag costs {:.2f} mm ({:.2f} to {:.2f}), {:.0f} %, {}",
                means_text(table, metric), 1e3 * cost_m, 1e3 * lag.difference, 1e3 * lag.interval.low,
                1e3 * lag.interval.high, 100 * lag.difference / cost_m, p_text(lag.p)),
            costs && lag.difference < cost_m && lag.p < 1e-3, costs};
}

// The model has no time between trials. It follows from the paper's first session, less half a minute of pause
// between its halves, and must then give the length of the second session.
Finding length_finding(const StudyColumns& one, const StudyColumns& two, const StudyColumns& three) {
    constexpr double kFirst_s = 9.13 * 60, kPause_s = 30, kSecond_s = 8.39 * 60, kTolerance = 0.05;
    const double trials = trials_per_subject(one) + trials_per_subject(two);
    const double between_s = (kFirst_s - kPause_s - session_s(one) - session_s(two)) / trials;
    const double second_s = session_s(three) + trials_per_subject(three) * between_s;
    return {fmt::format("{:.2f} s between trials make experiments 1 and 2 last 9.13 min; experiment 3 then "
                        "lasts {:.2f} min",
                        between_s, second_s / 60),
            between_s > 0 && std::fabs(second_s / kSecond_s - 1) < kTolerance};
}

}  // namespace thimble
