#include "analysis/report/report_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <fmt/format.h>

namespace thimble {
namespace {

constexpr std::array kOscillation{Metric::kOscillationPeakToPeak, Metric::kOscillationRms,
                                  Metric::kOscillationFrequency, Metric::kContactsLost};
constexpr std::array kTask{Metric::kPenetrationMean, Metric::kPenetrationMax, Metric::kCompletionTime};
constexpr std::array kTaskAndRemoval{Metric::kPenetrationMean, Metric::kPenetrationMax,
                                     Metric::kCompletionTime, Metric::kPeakDisplacement};

std::string shown(double value, Metric metric) {
    if (std::isnan(value)) return std::string(kDash);
    return shown_text(value, metric);
}

ReportTable statistics_table(std::string title, const std::vector<ConditionSummary>& conditions,
                             std::span<const Metric> metrics) {
    ReportTable table{
        std::move(title),
        "Mean and standard deviation (SD) over n subjects. The trials of each subject are averaged first.",
        {"delay", "modality", "trials"}};
    for (const Metric metric : metrics) {
        table.columns.emplace_back(info(metric).label);
        table.columns.emplace_back("SD");
        table.columns.emplace_back("n");
    }
    for (const ConditionSummary& condition : conditions) {
        std::vector<std::string> row{delay_text(condition.delay_s), to_string(condition.modality),
                                     fmt::format("{}", condition.judged)};
        for (const Metric metric : metrics) {
            const Statistic& statistic = condition.of(metric);
            row.push_back(shown(statistic.mean, metric));
            row.push_back(shown(statistic.sd, metric));
            row.push_back(fmt::format("{}", statistic.n));
        }
        table.rows.push_back(std::move(row));
    }
    drop_empty_columns(table);
    return table;
}

const TrialRow* counterpart(const TrialRow& row, const std::vector<TrialRow>& others) {
    const TrialConditions& a = row.conditions;
    const auto same = [&](const TrialRow& other) {
        const TrialConditions& b = other.conditions;
        return ran_to_its_end(other) && a.experiment == b.experiment && a.subject == b.subject &&
               a.trial == b.trial && a.modality == b.modality && same_delay(a.delay_s, b.delay_s);
    };
    const auto found = std::find_if(others.begin(), others.end(), same);
    return found == others.end() ? nullptr : &*found;
}

std::vector<std::string> trial_cells(const TrialConditions& conditions) {
    return {fmt::format("{}", conditions.subject), fmt::format("{}", conditions.trial),
            to_string(conditions.modality), delay_text(conditions.delay_s)};
}

void add_metrics(ReportTable& table, const TrialRow& real, const TrialRow& in_virtual_time) {
    std::vector<std::string> cells = trial_cells(real.conditions);
    for (const Metric metric : kTask) {
        const double real_value = info(metric).value(real.metrics);
        const double virtual_value = info(metric).value(in_virtual_time.metrics);
        cells.push_back(shown(real_value, metric));
        cells.push_back(shown(virtual_value, metric));
        cells.push_back(shown(real_value - virtual_value, metric));
    }
    table.rows.push_back(std::move(cells));
}

const char* class_text(bool oscillates) { return oscillates ? "oscillates" : "stable"; }

}  // namespace

ReportTable oscillation_table(const std::vector<ConditionSummary>& conditions) {
    return statistics_table("Movement of the needle during the hold", conditions, kOscillation);
}

ReportTable metrics_table(const std::vector<ConditionSummary>& conditions) {
    const bool removed = std::any_of(
        conditions.begin(), conditions.end(),
        [](const ConditionSummary& condition) { return condition.of(Metric::kPeakDisplacement).n > 0; });
    return statistics_table(
        "Penetration and completion time", conditions,
        removed ? std::span<const Metric>(kTaskAndRemoval) : std::span<const Metric>(kTask));
}

Agreement compare_trials(const std::vector<TrialRow>& real, const std::vector<TrialRow>& in_virtual_time) {
    Agreement agreement{
        {"Metrics without delay, trial by trial", "", {"subject", "trial", "modality", "delay"}, {}},
        {"Class of each trial",
         "",
         {"subject", "trial", "modality", "delay", "real processes", "virtual time", "same"},
         {}}};
    for (const Metric metric : kTask) {
        agreement.metrics.columns.push_back(fmt::format("{}, real", info(metric).label));
        agreement.metrics.columns.emplace_back("virtual");
        agreement.metrics.columns.emplace_back("difference");
    }
    for (const TrialRow& row : real) {
        const TrialRow* other = ran_to_its_end(row) ? counterpart(row, in_virtual_time) : nullptr;
        if (other == nullptr) {
            ++agreement.unmatched;
            continue;
        }
        ++agreement.compared;
        const bool same = row.metrics.oscillates == other->metrics.oscillates;
        if (same) ++agreement.same_class;
        if (same_delay(row.conditions.delay_s, 0)) add_metrics(agreement.metrics, row, *other);
        std::vector<std::string> cells = trial_cells(row.conditions);
        cells.insert(cells.end(), {class_text(row.metrics.oscillates), class_text(other->metrics.oscillates),
                                   same ? "yes" : "no"});
        agreement.classes.rows.push_back(std::move(cells));
    }
    return agreement;
}

}  // namespace thimble
