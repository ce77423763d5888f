#include "analysis/analysis.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "analysis/statistics/descriptive.hpp"
#include "common/error.hpp"

namespace thimble {
namespace {

class Analyst {
  public:
    Analyst(const StudyColumns& columns, Metric metric, AnalysisKind kind) : columns_(columns) {
        result_.experiment = columns.experiment();
        result_.metric = metric;
        result_.kind = kind;
        result_.within_subjects = columns.experiment() != 2;
    }

    MeasureAnalysis run() {
        if (columns_.empty()) {
            result_.problems.emplace_back("no trials of this experiment ran to their end");
        } else if (has_all_modalities()) {
            if (result_.within_subjects) {
                analyse_within();
            } else {
                analyse_between();
            }
        }
        return std::move(result_);
    }

  private:
    bool full() const { return result_.kind == AnalysisKind::kFull; }

    // What `compute` gives; if a test refuses the data, nothing, and its reason among the problems: of `what`
    // (the same test of another column or pair) the first one only.
    template <class Compute>
    auto attempt(const char* what, const Compute& compute) -> std::optional<decltype(compute())> {
        try {
            return compute();
        } catch (const Error& refused) {
            if (refused_.insert(what).second) note(refused.what());
            return std::nullopt;
        }
    }

    void note(std::string problem) {
        auto& problems = result_.problems;
        if (std::find(problems.begin(), problems.end(), problem) == problems.end())
            problems.push_back(std::move(problem));
    }

    // Named here, because the statistics would only see a table without a complete row.
    bool has_all_modalities() {
        std::string missing;
        for (const NamedValues& group : columns_.groups(result_.metric)) {
            if (group.values.empty()) missing += (missing.empty() ? "" : ", ") + group.name;
        }
        if (!missing.empty()) note("no trial of " + missing + " has a value; the tests need all modalities");
        return missing.empty();
    }

    void describe(NamedValues values) {
        ColumnAnalysis column;
        column.mean = sample_mean(values);
        column.median = sample_median(values);
        column.lower_quartile = sample_quantile(values, 0.25);
        column.upper_quartile = sample_quantile(values, 0.75);
        column.sd = attempt("sd", [&] { return sample_sd(values); });
        column.mean_interval = attempt("mean", [&] { return mean_interval(values, 1 - kAnalysisLevel); });
        column.normality = attempt("normality", [&] { return normality(values); });
        column.values = std::move(values);
        result_.columns.push_back(std::move(column));
    }

    bool all_normal() const {
        return std::all_of(result_.columns.begin(), result_.columns.end(),
                           [](const ColumnAnalysis& c) { return c.normality && !c.fails_normality(); });
    }

    void make_pairs() {
        for (std::size_t first = 0; first < result_.columns.size(); ++first) {
            for (std::size_t second = first + 1; second < result_.columns.size(); ++second) {
                result_.pairs.push_back({first, second, {}, {}, {}, {}});
            }
        }
    }

    // The statistics list pairs in the same order as make_pairs(), but may leave some out.
    template <class Pair>
    void keep(const std::vector<Pair>& pairs, std::optional<Pair> PairAnalysis::*where) {
        auto to = result_.pairs.begin();
        for (const Pair& pair : pairs) {
            while (to->first != pair.first || to->second != pair.second) ++to;
            (*to).*where = pair;
        }
    }
    template <class Pair>
    void keep(const std::optional<std::vector<Pair>>& pairs, std::optional<Pair> PairAnalysis::*where) {
        if (pairs) keep(*pairs, where);
    }

    void analyse_within() {
        const auto complete = attempt("table", [&] { return columns_.table(result_.metric); });
        if (!complete) return;
        const SampleTable& table = complete->table;
        result_.subjects = table.subjects();
        for (const std::size_t row : complete->dropped) result_.left_out.push_back(columns_.subjects()[row]);
        for (std::size_t i = 0; i < table.conditions(); ++i) describe(table.column(i));
        make_pairs();
        result_.chosen = all_normal() ? ChosenTest::kRepeatedAnova : ChosenTest::kFriedman;
        if (full() || result_.chosen == ChosenTest::kRepeatedAnova) by_means(table);
        if (full() || result_.chosen == ChosenTest::kFriedman) by_ranks(table);
        if (full()) by_differences(table);
    }

    void by_means(const SampleTable& table) {
        result_.repeated_anova = attempt("anova", [&] { return repeated_anova(table); });
        if (!result_.repeated_anova) return;
        const RepeatedAnova& anova = *result_.repeated_anova;
        keep(attempt("pairs", [&] { return pairs_after_repeated_anova(table, 1 - kAnalysisLevel); }),
             &PairAnalysis::pooled);
        if (full()) add_eta_squared(anova.f, anova.df_conditions, anova.df_error);
    }

    void by_ranks(const SampleTable& table) {
        result_.friedman = attempt("friedman", [&] { return friedman(table); });
        if (!result_.friedman) return;
        keep(attempt("dunn", [&] { return dunn_after_friedman(table); }), &PairAnalysis::dunn);
    }

    void by_differences(const SampleTable& table) {
        if (const auto paired =
                attempt("paired", [&] { return paired_t_tests(table, 1 - kAnalysisLevel); })) {
            keep(paired->pairs, &PairAnalysis::paired);
            for (const std::string& refused : paired->refused) note(refused);
        }
        for (PairAnalysis& pair : result_.pairs) {
            pair.d_z = attempt("d_z", [&] {
                return cohens_dz(table.column(pair.first), table.column(pair.second), 1 - kAnalysisLevel);
            });
        }
    }

    void analyse_between() {
        const std::vector<NamedValues> groups = columns_.groups(result_.metric);
        for (const NamedValues& group : groups) result_.subjects += group.values.size();
        for (const NamedValues& group : groups) describe(group);
        make_pairs();
        result_.chosen = ChosenTest::kOneWayAnova;
        result_.one_way_anova = attempt("anova", [&] { return one_way_anova(groups); });
        if (!result_.one_way_anova) return;
        const OneWayAnova& anova = *result_.one_way_anova;
        keep(attempt("pairs", [&] { return pairs_after_one_way_anova(groups, 1 - kAnalysisLevel); }),
             &PairAnalysis::pooled);
        if (full()) add_eta_squared(anova.f, anova.df_between, anova.df_within);
    }

    void add_eta_squared(double f, double df_1, double df_2) {
        result_.eta_squared_interval =
            attempt("eta", [&] { return eta_squared_interval(f, df_1, df_2, 1 - kAnalysisLevel); });
    }

    const StudyColumns& columns_;
    std::set<std::string> refused_;
    MeasureAnalysis result_;
};

}  // namespace

const char* to_string(AnalysisKind kind) { return kind == AnalysisKind::kPaper ? "paper" : "full"; }

std::optional<AnalysisKind> parse_analysis(std::string_view text) {
    for (const AnalysisKind kind : {AnalysisKind::kPaper, AnalysisKind::kFull}) {
        if (text == to_string(kind)) return kind;
    }
    return std::nullopt;
}

const char* to_string(ChosenTest test) {
    switch (test) {
        case ChosenTest::kRepeatedAnova:
            return "repeated-measures ANOVA";
        case ChosenTest::kFriedman:
            return "Friedman";
        case ChosenTest::kOneWayAnova:
            return "one-way ANOVA";
        case ChosenTest::kNone:
            break;
    }
    return "none";
}

std::optional<double> MeasureAnalysis::p() const {
    if (chosen == ChosenTest::kRepeatedAnova && repeated_anova) return repeated_anova->p;
    if (chosen == ChosenTest::kFriedman && friedman) return friedman->p();
    if (chosen == ChosenTest::kOneWayAnova && one_way_anova) return one_way_anova->p;
    return std::nullopt;
}

std::optional<double> MeasureAnalysis::p_of(const PairAnalysis& pair) const {
    if (chosen == ChosenTest::kFriedman) {
        return pair.dunn ? std::optional(pair.dunn->p_adjusted) : std::nullopt;
    }
    return pair.pooled ? std::optional(pair.pooled->p_bonferroni) : std::nullopt;
}

const std::optional<MeanPair>& MeasureAnalysis::by_means(const PairAnalysis& pair) const {
    const bool are_paired = std::any_of(pairs.begin(), pairs.end(),
                                        [](const PairAnalysis& any) { return any.paired.has_value(); });
    return are_paired ? pair.paired : pair.pooled;
}

MeasureAnalysis analyse_measure(const StudyColumns& columns, Metric metric, AnalysisKind kind) {
    return Analyst(columns, metric, kind).run();
}

std::vector<Metric> measures_of(std::uint32_t experiment) {
    if (experiment == 2) return {Metric::kPeakDisplacement};
    return {Metric::kPenetrationMean, Metric::kPenetrationMax, Metric::kCompletionTime};
}

std::vector<MeasureAnalysis> analyse_trials(const std::vector<TrialRow>& rows, AnalysisKind kind) {
    std::vector<MeasureAnalysis> measures;
    for (const std::uint32_t experiment : {1U, 2U, 3U}) {
        if (of_experiment(rows, experiment).empty()) continue;
        const StudyColumns columns(rows, experiment);
        for (const Metric metric : measures_of(experiment)) {
            measures.push_back(analyse_measure(columns, metric, kind));
        }
    }
    return measures;
}

}  // namespace thimble
