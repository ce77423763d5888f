// Trials condensed per modality and delay: what tables and bars are made from. The trials of
// one subject are averaged first, so mean and standard deviation are over subjects, as in the paper.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "session/records/trial_table.hpp"

namespace thimble {

enum class Metric : std::uint8_t {
    kPenetrationMean,
    kPenetrationMax,
    kCompletionTime,
    kPeakDisplacement,
    kOscillationPeakToPeak,
    kOscillationRms,
    kOscillationFrequency,
    kContactsLost,
};
inline constexpr std::size_t kMetrics = 8;

struct MetricInfo {
    std::string_view name;   // as in trials.csv, SI
    std::string_view label;  // for people, with the unit shown
    double shown_per_si;     // 1000 if millimetres are shown
    int decimals;
    double (*value)(const TrialMetrics&);  // SI
};
const MetricInfo& info(Metric metric);
// An SI value as it is shown, without the unit: "3.93"; never "-0.00".
std::string shown_text(double value, Metric metric);

// How a trial went, as far as it got: "completed, 5.3 s, maximum penetration 1.20 mm".
std::string course_text(const TrialRow& row);

struct Statistic {
    std::uint32_t n = 0;                                     // subjects that have the metric
    double mean = std::numeric_limits<double>::quiet_NaN();  // SI; NaN with n = 0
    double sd = std::numeric_limits<double>::quiet_NaN();    // n - 1; NaN below two subjects
};

struct ConditionSummary {
    Modality modality = Modality::kHF;
    double delay_s = 0;
    std::uint32_t trials = 0;  // all of them
    // Judged: ran to beep and withdrawal or to the time-out, and touched the fixture. An interrupted trial,
    // or one that never got there, says nothing about whether contact is held.
    std::uint32_t judged = 0;
    std::uint32_t oscillating = 0;  // of the judged
    std::uint32_t beeped = 0;       // of the judged
    std::uint32_t subjects = 0;     // with a judged trial
    std::array<Statistic, kMetrics> statistics;

    const Statistic& of(Metric metric) const { return statistics[static_cast<std::size_t>(metric)]; }
};

// Sorted by delay, then modality. Experiments are not told apart: pass one, or those that may be pooled.
std::vector<ConditionSummary> summarize(const std::vector<TrialRow>& rows);

bool same_delay(double a_s, double b_s);  // to the nanosecond
std::string delay_text(double delay_s);   // "50 ms"

// For anything that has a modality and a delay_s.
template <class Items>
auto find_condition(Items&& items, Modality modality, double delay_s) {
    return std::find_if(items.begin(), items.end(), [&](const auto& item) {
        return item.modality == modality && same_delay(item.delay_s, delay_s);
    });
}

// Each delay once, ascending.
template <class Items>
std::vector<double> delays_of(const Items& items) {
    std::vector<double> delays_s;
    delays_s.reserve(items.size());
    for (const auto& item : items) delays_s.push_back(item.delay_s);
    std::sort(delays_s.begin(), delays_s.end());
    delays_s.erase(std::unique(delays_s.begin(), delays_s.end(), same_delay), delays_s.end());
    return delays_s;
}
std::vector<double> delays_of(const std::vector<TrialRow>& rows);

}  // namespace thimble
