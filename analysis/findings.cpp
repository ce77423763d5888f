#include "analysis/findings.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/statistics/descriptive.hpp"
#include "common/json_text.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

OscillationShare share_of(const std::string& condition, const std::vector<TrialRow>& rows) {
    OscillationShare share;
    share.condition = condition;
    std::set<std::uint32_t> subjects;
    for (const TrialRow& row : rows) {
        if (std::isnan(row.metrics.first_contact_time_s)) continue;
        ++share.trials;
        share.oscillating += row.metrics.oscillates;
        subjects.insert(row.conditions.subject);
    }
    share.subjects = subjects.size();
    if (share.trials > 0) share.interval = wilson_interval(share.oscillating, share.trials);
    return share;
}

std::vector<std::pair<std::string, Metric>> unmeasured_in(const StudyColumns& columns, Metric metric) {
    const std::vector<NamedValues> values = columns.groups(metric);
    const auto lacks = [](const NamedValues& column) { return column.values.empty(); };
    std::vector<std::pair<std::string, Metric>> unmeasured;
    if (std::all_of(values.begin(), values.end(), lacks)) return unmeasured;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (lacks(values[i]) && !columns.rows_of(columns.conditions()[i]).empty())
            unmeasured.emplace_back(values[i].name, metric);
    }
    return unmeasured;
}

GroupFindings find_in(const std::vector<TrialRow>& rows, std::uint32_t experiment, double delay_s) {
    GroupFindings group;
    group.experiment = experiment;
    group.delay_s = delay_s;
    const StudyColumns columns(rows, experiment, delay_s);
    for (const StudyColumns::Condition& condition : columns.conditions()) {
        const std::vector<TrialRow> own = columns.rows_of(condition);
        if (!own.empty()) group.oscillations.push_back(share_of(condition.name, own));
    }
    for (const Metric metric : measures_of(experiment)) {
        const std::vector<ConditionPair> pairs = compare_conditions(columns, metric);
        group.comparisons.insert(group.comparisons.end(), pairs.begin(), pairs.end());
        const auto unmeasured = unmeasured_in(columns, metric);
        group.unmeasured.insert(group.unmeasured.end(), unmeasured.begin(), unmeasured.end());
    }
    return group;
}

nlohmann::ordered_json json_of(const std::optional<ConfidenceInterval>& interval) {
    if (!interval) return nullptr;
    return {interval->low, interval->high};
}

nlohmann::ordered_json json_of(const OscillationShare& share, const GroupFindings& group) {
    std::optional<double> of_trials;
    if (share.trials > 0)
        of_trials = static_cast<double>(share.oscillating) / static_cast<double>(share.trials);
    return {{"comparison", fmt::format("{} oscillates, {}", share.condition, group.name)},
            {"n", share.subjects},
            {"difference", or_null(of_trials)},
            {"interval", json_of(share.interval)},
            {"P", nullptr},
            {"words", words(share, group)}};
}

nlohmann::ordered_json json_of(const ConditionPair& c, const GroupFindings& group) {
    std::optional<double> estimate, p;
    if (c.shift) estimate = c.shift->estimate;
    if (c.can_be_judged()) p = c.shift->p;
    return {{"comparison", fmt::format("{} - {}, {}, {}", c.first, c.second, name_of(c.metric), group.name)},
            {"n", c.subjects},
            {"difference", or_null(estimate)},
            {"interval", json_of(c.shift ? c.shift->interval : std::nullopt)},
            {"P", or_null(p)},
            {"words", words(c, group)}};
}

}  // namespace

std::vector<GroupFindings> findings_of(const std::vector<TrialRow>& rows) {
    std::vector<GroupFindings> groups;
    std::set<std::uint32_t> experiments;
    for (const TrialRow& row : rows) experiments.insert(row.conditions.experiment);
    for (const std::uint32_t experiment : experiments) {
        for (const double delay_s : delays_of(of_experiment(rows, experiment))) {
            GroupFindings group = find_in(rows, experiment, delay_s);
            group.name = delay_text(delay_s);
            if (experiments.size() > 1) group.name += fmt::format(" in experiment {}", experiment);
            groups.push_back(std::move(group));
        }
    }
    return groups;
}

nlohmann::ordered_json to_json(const std::vector<GroupFindings>& groups) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const GroupFindings& group : groups) {
        for (const OscillationShare& share : group.oscillations) list.push_back(json_of(share, group));
        for (const ConditionPair& comparison : group.comparisons) list.push_back(json_of(comparison, group));
    }
    return list;
}

void write_findings(const std::vector<GroupFindings>& groups, const std::filesystem::path& json) {
    write_text_file(json, json_text(to_json(groups), 2) + "\n");
}

}  // namespace thimble
