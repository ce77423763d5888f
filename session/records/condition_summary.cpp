#include "session/records/condition_summary.hpp"

#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "common/time.hpp"
#include "session/records/mean_trajectory.hpp"

namespace thimble {
namespace {

template <auto M>
double member(const TrialMetrics& metrics) {
    return static_cast<double>(metrics.*M);
}

using T = TrialMetrics;
constexpr std::array<MetricInfo, kMetrics> kInfo{{
    {"penetration_mean_m", "mean penetration (mm)", 1e3, 2, member<&T::penetration_mean_m>},
    {"penetration_max_m", "maximum penetration (mm)", 1e3, 2, member<&T::penetration_max_m>},
    {"completion_time_s", "completion time (s)", 1, 2, member<&T::completion_time_s>},
    {"peak_displacement_m", "peak displacement (mm)", 1e3, 2, member<&T::peak_displacement_m>},
    {"oscillation_peak_to_peak_m", "peak to peak (mm)", 1e3, 2, member<&T::oscillation_peak_to_peak_m>},
    {"oscillation_rms_m", "rms (mm)", 1e3, 2, member<&T::oscillation_rms_m>},
    {"oscillation_frequency_Hz", "frequency (Hz)", 1, 2, member<&T::oscillation_frequency_Hz>},
    {"contacts_lost", "contacts lost per trial", 1, 2, member<&T::contacts_lost>},
}};

using ConditionKey = std::pair<Duration, Modality>;
using SubjectKey = std::pair<std::uint32_t, std::uint32_t>;  // experiment, subject
using SubjectMeans = std::map<SubjectKey, std::array<CurveStatistics, kMetrics>>;

void add_row(const TrialRow& row, ConditionSummary& summary, SubjectMeans& subjects) {
    ++summary.trials;
    if (!ran_to_its_end(row) || std::isnan(row.metrics.first_contact_time_s)) return;
    ++summary.judged;
    if (row.metrics.oscillates) ++summary.oscillating;
    if (row.metrics.beeped) ++summary.beeped;
    auto& means = subjects[{row.conditions.experiment, row.conditions.subject}];
    for (std::size_t i = 0; i < kMetrics; ++i) {
        const double value = kInfo[i].value(row.metrics);
        if (!std::isnan(value)) means[i].add(value);
    }
}

Statistic over_subjects(const SubjectMeans& subjects, std::size_t metric) {
    CurveStatistics over;
    for (const auto& [key, means] : subjects) {
        if (means[metric].n > 0) over.add(means[metric].mean);
    }
    Statistic statistic;
    statistic.n = over.n;
    if (over.n > 0) statistic.mean = over.mean;
    statistic.sd = over.sd();
    return statistic;
}

}  // namespace

const MetricInfo& info(Metric metric) { return kInfo[static_cast<std::size_t>(metric)]; }

std::string shown_text(double value, Metric metric) {
    std::string text = fmt::format("{:.{}f}", value * info(metric).shown_per_si, info(metric).decimals);
    if (text.starts_with('-') && text.find_first_of("123456789") == std::string::npos) text.erase(0, 1);
    return text;
}

std::string course_text(const TrialRow& row) {
    const TrialMetrics& m = row.metrics;
    std::string text = outcome_text(row.reason, row.lost_peer);
    if (!std::isnan(m.completion_time_s)) {
        text += fmt::format(", {:.1f} s", m.completion_time_s);
    } else if (!std::isnan(m.duration_s)) {
        text += fmt::format(", ended after {:.1f} s", m.duration_s);
    }
    if (!std::isnan(m.penetration_max_m))
        text += fmt::format(", maximum penetration {:.2f} mm", 1000 * m.penetration_max_m);
    return text;
}

std::vector<ConditionSummary> summarize(const std::vector<TrialRow>& rows) {
    std::map<ConditionKey, std::pair<ConditionSummary, SubjectMeans>> conditions;
    for (const TrialRow& row : rows) {
        const TrialConditions& of = row.conditions;
        auto& [summary, subjects] = conditions[{from_seconds(of.delay_s), of.modality}];
        summary.modality = of.modality;
        summary.delay_s = of.delay_s;
        add_row(row, summary, subjects);
    }
    std::vector<ConditionSummary> summaries;
    for (auto& [key, condition] : conditions) {
        auto& [summary, subjects] = condition;
        summary.subjects = static_cast<std::uint32_t>(subjects.size());
        for (std::size_t i = 0; i < kMetrics; ++i) summary.statistics[i] = over_subjects(subjects, i);
        summaries.push_back(summary);
    }
    return summaries;
}

bool same_delay(double a_s, double b_s) { return from_seconds(a_s) == from_seconds(b_s); }

std::string delay_text(double delay_s) { return fmt::format("{:g} ms", delay_s * 1e3); }

std::vector<double> delays_of(const std::vector<TrialRow>& rows) {
    std::vector<TrialConditions> trials;
    trials.reserve(rows.size());
    for (const TrialRow& row : rows) trials.push_back(row.conditions);
    return delays_of(trials);
}

}  // namespace thimble
