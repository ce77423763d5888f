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

Comparison paired_comparison(Comparison comparison, const NamedValues& first, const NamedValues& second) {
    NamedValues differences{fmt::format("{} - {}", first.name, second.name), {}};
    for (std::size_t s = 0; s < first.values.size(); ++s) {
        const double difference = first.values[s] - second.values[s];
        if (!std::isnan(difference)) differences.values.push_back(difference);
    }
    comparison.n = comparison.subjects = differences.values.size();
    if (comparison.n > 0) comparison.shift = signed_rank(differences, comparison.family, kFindingLevel);
    return comparison;
}

std::size_t subjects_of(const StudyColumns& columns, Metric metric, const std::string& first,
                        const std::string& second) {
    std::set<std::uint32_t> subjects;
    for (const StudyColumns::Condition& condition : columns.conditions()) {
        if (condition.name != first && condition.name != second) continue;
        for (const TrialRow& row : columns.rows_of(condition)) {
            if (!std::isnan(info(metric).value(row.metrics))) subjects.insert(row.conditions.subject);
        }
    }
    return subjects.size();
}

// Of experiment 2: each trial another subject's or modality's.
Comparison independent_comparison(Comparison comparison, const StudyColumns& columns,
                                  const NamedValues& first, const NamedValues& second) {
    comparison.paired = false;
    comparison.n = first.values.size() + second.values.size();
    comparison.subjects = subjects_of(columns, comparison.metric, first.name, second.name);
    comparison.shift = rank_sum(first, second, comparison.family, kFindingLevel);
    return comparison;
}

bool has_values(const NamedValues& column) {
    return std::any_of(column.values.begin(), column.values.end(),
                       [](double value) { return !std::isnan(value); });
}

void compare(GroupFindings& group, const StudyColumns& columns, Metric metric) {
    const bool paired = columns.experiment() != 2;
    std::vector<NamedValues> values = paired ? columns.subject_means(metric) : columns.groups(metric);
    std::erase_if(values, [](const NamedValues& column) { return !has_values(column); });
    const std::size_t pairs = values.size() * (values.size() - 1) / 2;
    for (std::size_t a = 0; a + 1 < values.size(); ++a) {
        for (std::size_t b = a + 1; b < values.size(); ++b) {
            Comparison blank{metric, values[a].name, values[b].name, 0, 0, pairs, paired, {}};
            group.comparisons.push_back(
                paired ? paired_comparison(std::move(blank), values[a], values[b])
                       : independent_comparison(std::move(blank), columns, values[a], values[b]));
        }
    }
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
    for (const Metric metric : measures_of(experiment)) compare(group, columns, metric);
    return group;
}

template <class Value>
nlohmann::ordered_json or_null(const std::optional<Value>& value) {
    return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
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

nlohmann::ordered_json json_of(const Comparison& c, const GroupFindings& group) {
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

std::size_t Comparison::fewest() const {
    return paired ? fewest_for_signed_rank(family, kFindingLevel) : fewest_for_rank_sum(family, kFindingLevel);
}

std::vector<GroupFindings> find(const std::vector<TrialRow>& rows) {
    std::vector<GroupFindings> groups;
    std::set<std::uint32_t> experiments;
    for (const TrialRow& row : rows) experiments.insert(row.conditions.experiment);
    for (const std::uint32_t experiment : experiments) {
        std::vector<TrialConditions> trials;
        for (const TrialRow& row : of_experiment(rows, experiment)) trials.push_back(row.conditions);
        for (const double delay_s : delays_of(trials)) {
            GroupFindings group = find_in(rows, experiment, delay_s);
            group.name = delay_text(delay_s);
            if (experiments.size() > 1) group.name += fmt::format(", experiment {}", experiment);
            groups.push_back(std::move(group));
        }
    }
    return groups;
}

nlohmann::ordered_json to_json(const std::vector<GroupFindings>& groups) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const GroupFindings& group : groups) {
        for (const OscillationShare& share : group.oscillations) list.push_back(json_of(share, group));
        for (const Comparison& comparison : group.comparisons) list.push_back(json_of(comparison, group));
    }
    return list;
}

void write_findings(const std::vector<GroupFindings>& groups, const std::filesystem::path& json) {
    write_text_file(json, json_text(to_json(groups), 2) + "\n");
}

}  // namespace thimble
