// Experiments 1 to 3: the paper's own tests.
#include "analysis/claims/claim_findings.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "analysis/statistics/anova.hpp"
#include "analysis/statistics/descriptive.hpp"
#include "analysis/statistics/friedman.hpp"
#include "analysis/statistics/normality.hpp"
#include "analysis/statistics/pairwise.hpp"

namespace thimble {
namespace {

// Columns HF, CF, CCF, VF ascend.
bool in_order(const SampleTable& table) {
    for (std::size_t i = 1; i < table.conditions(); ++i) {
        if (sample_mean(table.column(i - 1)) >= sample_mean(table.column(i))) return false;
    }
    return true;
}

// The columns that fail the test of normality, each with its P.
std::string not_normal(const StudyColumns& columns, Metric metric) {
    constexpr double kLevel = 0.05;
    const SampleTable table = columns.table(metric).table;
    std::string names;
    for (std::size_t i = 0; i < table.conditions(); ++i) {
        const Normality test = normality(table.column(i));
        if (test.p < kLevel) names += fmt::format(" {} ({})", table.name(i), p_text(test.p));
    }
    return names.empty() ? " none" : names;
}

std::string group_means(const std::vector<NamedValues>& groups) {
    std::string text;
    for (const NamedValues& group : groups) {
        text += fmt::format("{}{} {:.2f}", text.empty() ? "" : ", ", group.name, 1e3 * sample_mean(group));
    }
    return text + " mm";
}

// A subject without a value in a modality (HF never reached the beep) has no row.
std::string left_out_text(const StudyColumns& columns, const CompleteRows& complete) {
    if (complete.dropped.empty()) return "";
    return fmt::format("{} of {} subjects; ", complete.table.subjects(), columns.subjects().size());
}

}  // namespace

std::string p_text(double p) { return p > 0 ? fmt::format("P = {:.2g}", p) : "P < 1e-300"; }

std::string means_text(const SampleTable& table, Metric metric) {
    std::string text;
    for (std::size_t i = 0; i < table.conditions(); ++i) {
        text += fmt::format("{}{} {:.{}f}", i > 0 ? ", " : "", table.name(i),
                            sample_mean(table.column(i)) * info(metric).shown_per_si, info(metric).decimals);
    }
    return fmt::format("{}: {}", info(metric).label, text);
}

Finding order_finding(const StudyColumns& columns, Metric metric) {
    const SampleTable table = columns.table(metric).table;
    const RepeatedAnova anova = repeated_anova(table);
    return {fmt::format("{}; F({:g}, {:g}) = {:.1f}, {}, Greenhouse-Geisser {}, partial eta^2 = {:.2f}",
                        means_text(table, metric), anova.df_conditions, anova.df_error, anova.f,
                        p_text(anova.p), p_text(anova.p_greenhouse_geisser), anova.partial_eta_squared),
            in_order(table) && anova.p < kHighlySignificant, in_order(table)};
}

Finding pairs_finding(const StudyColumns& columns, Metric metric, double limit_cf_ccf) {
    const SampleTable table = columns.table(metric).table;
    bool all = true;
    bool ascending = true;
    std::string text;
    for (const MeanPair& pair : pairs_after_repeated_anova(table)) {
        const bool cf_ccf = table.name(pair.first) == "CF" && table.name(pair.second) == "CCF";
        ascending = ascending && pair.difference < 0;
        all = all && ascending && pair.p_bonferroni < (cf_ccf ? limit_cf_ccf : 1e-3);
        text += fmt::format("{}{} - {} {}", text.empty() ? "" : ", ", table.name(pair.first),
                            table.name(pair.second), p_text(pair.p_bonferroni));
    }
    return {text, all, ascending};
}

Finding normality_finding(const StudyColumns& columns) {
    const std::string mean = not_normal(columns, Metric::kPenetrationMean);
    const std::string max = not_normal(columns, Metric::kPenetrationMax);
    const std::string time = not_normal(columns, Metric::kCompletionTime);
    return {
        fmt::format("not normal at .05: mean penetration{}; maximum penetration{}; time{}", mean, max, time),
        mean == " none" && max == " none" && time != " none"};
}

Finding skewed_handle_finding(const StudyColumns& columns) {
    const std::string names = not_normal(columns, Metric::kPenetrationMax);
    return {fmt::format("not normal at .05: maximum penetration{}", names), names.starts_with(" HF")};
}

Finding same_time_finding(const StudyColumns& columns) {
    const SampleTable table = columns.table(Metric::kCompletionTime).table;
    const Friedman test = friedman(table);
    return {fmt::format("{}; chi^2 = {:.2f}, {}, W = {:.2f}", means_text(table, Metric::kCompletionTime),
                        test.chi_squared, p_text(test.p()), test.kendalls_w),
            test.p() > kNoDifference};
}

Finding removal_finding(const StudyColumns& columns) {
    const auto groups = columns.groups(Metric::kPeakDisplacement);
    const OneWayAnova anova = one_way_anova(groups);
    return {fmt::format("{}; F({:g}, {:g}) = {:.1f}, {}", group_means(groups), anova.df_between,
                        anova.df_within, anova.f, p_text(anova.p)),
            anova.p < kHighlySignificant};
}

Finding removal_pairs_finding(const StudyColumns& columns, bool with_handle) {
    const auto groups = columns.groups(Metric::kPeakDisplacement);
    Finding finding{"", true, {}};
    if (with_handle) finding.direction = true;
    for (const MeanPair& pair : pairs_after_one_way_anova(groups)) {
        if ((pair.first == 0) != with_handle) continue;
        if (with_handle) finding.direction = *finding.direction && pair.difference > 0;
        const bool as_claimed =
            with_handle ? pair.difference > 0 && pair.p_bonferroni < 1e-3 : pair.p_bonferroni >= 0.05;
        finding.reproduced = finding.reproduced && as_claimed;
        finding.ours += fmt::format("{}{} - {} {}", finding.ours.empty() ? "" : ", ", groups[pair.first].name,
                                    groups[pair.second].name, p_text(pair.p_bonferroni));
    }
    return finding;
}

// HF in more than half of its trials, the others in none.
Finding stability_finding(const StudyColumns& columns) {
    std::string text;
    bool only_handle = true;
    for (const StudyColumns::Condition& condition : columns.conditions()) {
        const std::vector<TrialRow> rows = columns.rows_of(condition);
        const auto oscillating = static_cast<std::size_t>(std::count_if(
            rows.begin(), rows.end(), [](const TrialRow& row) { return row.metrics.oscillates; }));
        const bool as_claimed =
            condition.modality == Modality::kHF ? 2 * oscillating > rows.size() : oscillating == 0;
        only_handle = only_handle && !rows.empty() && as_claimed;
        text += fmt::format("{}{} {} of {}", text.empty() ? "trials that oscillate: " : ", ", condition.name,
                            oscillating, rows.size());
    }
    return {text, only_handle};
}

Finding friedman_finding(const StudyColumns& columns, Metric metric) {
    const CompleteRows complete = columns.table(metric);
    const SampleTable& table = complete.table;
    const Friedman test = friedman(table);
    std::string ranks;
    for (std::size_t i = 0; i < table.conditions(); ++i) {
        ranks += fmt::format("{}{} {:.1f}", i > 0 ? ", " : "", table.name(i), test.mean_ranks[i]);
    }
    return {fmt::format("{}{}; mean ranks {}; chi^2 = {:.2f}, {} (asymptotic {})",
                        left_out_text(columns, complete), means_text(table, metric), ranks, test.chi_squared,
                        test.p_exact ? "exact " + p_text(*test.p_exact) : "no exact P",
                        p_text(test.p_asymptotic)),
            test.p() < kHighlySignificant};
}

Finding dunn_finding(const StudyColumns& columns, Metric metric, std::string_view larger,
                     std::string_view smaller, double level) {
    const SampleTable table = columns.table(metric).table;
    for (const DunnPair& pair : dunn_after_friedman(table)) {
        const bool forwards = table.name(pair.first) == larger && table.name(pair.second) == smaller;
        const bool backwards = table.name(pair.first) == smaller && table.name(pair.second) == larger;
        if (!forwards && !backwards) continue;
        const double difference = forwards ? pair.mean_rank_difference : -pair.mean_rank_difference;
        const bool is_larger = difference > 0;
        return {fmt::format("mean rank difference {:.2f}, {}", difference, p_text(pair.p_adjusted)),
                is_larger && pair.p_adjusted < level, is_larger};
    }
    return {"not judged: this pair is missing", false};
}

Finding same_ranks_finding(const StudyColumns& columns, Metric metric, const NamedPairs& pairs) {
    const SampleTable table = columns.table(metric).table;
    Finding finding{"", true};
    std::size_t found = 0;
    for (const DunnPair& pair : dunn_after_friedman(table)) {
        const std::pair<std::string_view, std::string_view> names{table.name(pair.first),
                                                                  table.name(pair.second)};
        if (std::find(pairs.begin(), pairs.end(), names) == pairs.end()) continue;
        ++found;
        finding.reproduced = finding.reproduced && pair.p_adjusted >= 0.05;
        finding.ours += fmt::format("{}{} - {} {}", finding.ours.empty() ? "" : ", ", names.first,
                                    names.second, p_text(pair.p_adjusted));
    }
    if (found != pairs.size()) return {"not judged: some of these pairs are missing", false};
    return finding;
}

Finding only_delay_finding(const StudyColumns& without, const StudyColumns& with) {
    const double p_without = friedman(without.table(Metric::kCompletionTime).table).p();
    const double p_with = friedman(with.table(Metric::kCompletionTime).table).p();
    return {fmt::format("time: {} without delay, {} with", p_text(p_without), p_text(p_with)),
            p_without > kNoDifference && p_with < kHighlySignificant};
}

}  // namespace thimble
