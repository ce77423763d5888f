// One measure of one experiment, analysed: which test the paper's rule chooses, what it says, which pairs of
// modalities differ and by how much. Every number comes from analysis/statistics; what a test refuses (too few
// subjects, a modality without trials) becomes a sentence in `problems`, and the rest is still there.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "analysis/statistics/anova.hpp"
#include "analysis/statistics/effect_size.hpp"
#include "analysis/statistics/friedman.hpp"
#include "analysis/statistics/normality.hpp"
#include "analysis/statistics/pairwise.hpp"
#include "analysis/tables/study_columns.hpp"
#include "analysis/text/html.hpp"

namespace thimble {

enum class AnalysisKind : std::uint8_t {
    kPaper,  // what the paper computed, and nothing else
    kFull,   // beside it what its design allows: corrections, effect sizes, intervals
};
const char* to_string(AnalysisKind kind);  // "paper", "full"
std::optional<AnalysisKind> parse_analysis(std::string_view text);

// Of normality, tests and pairs; the confidence of intervals is 1 minus it.
inline constexpr double kAnalysisLevel = 0.05;

enum class ChosenTest : std::uint8_t { kNone, kRepeatedAnova, kFriedman, kOneWayAnova };
const char* to_string(ChosenTest test);

struct ColumnAnalysis {
    NamedValues values;  // of a modality, SI: a subject's mean each; without repetition a trial each
    double mean = 0;     // SI, as all that follows
    std::optional<double> sd;
    std::optional<ConfidenceInterval> mean_interval;
    double median = 0, lower_quartile = 0, upper_quartile = 0;
    std::optional<Normality> normality;  // K2; nothing where it is refused

    bool fails_normality() const { return normality && normality->p < kAnalysisLevel; }
};

struct PairAnalysis {
    std::size_t first = 0, second = 0;  // of the columns
    // First minus second. By the error of the analysis of variance, P times six: the paper's after ANOVA.
    std::optional<MeanPair> pooled;
    std::optional<DunnPair> dunn;  // the paper's after Friedman
    // By the subjects' own differences, which needs no sphericity.
    std::optional<MeanPair> paired;
    std::optional<CohensDz> d_z;
};

struct MeasureAnalysis {
    std::uint32_t experiment = 0;
    Metric metric = Metric::kPenetrationMean;
    AnalysisKind kind = AnalysisKind::kFull;
    bool within_subjects = true;          // false: every trial another subject's or modality's (experiment 2)
    std::size_t subjects = 0;             // that the tests are about; of experiment 2: trials
    std::vector<std::uint32_t> left_out;  // subjects without a value in some modality
    std::vector<ColumnAnalysis> columns;  // in the order of kModalities; empty if there is no table
    ChosenTest chosen = ChosenTest::kNone;  // by the paper's rule
    std::optional<RepeatedAnova> repeated_anova;
    std::optional<OneWayAnova> one_way_anova;
    std::optional<Friedman> friedman;
    std::optional<ConfidenceInterval> eta_squared_interval;  // of the ANOVA's partial eta^2
    std::vector<PairAnalysis> pairs;                         // all six
    std::vector<std::string> problems;                       // sentences

    // Of the chosen test, and of a pair by the comparison that belongs to it; nothing where it was refused.
    std::optional<double> p() const;
    std::optional<double> p_of(const PairAnalysis& pair) const;
    // By the subjects' own differences where the measure has any, else by the error of the analysis of variance.
    const std::optional<MeanPair>& by_means(const PairAnalysis& pair) const;
    bool differs() const { return p().value_or(1) < kAnalysisLevel; }
};

// Experiments 1 and 3, by the paper's rule: K2 on each column; if none fails, ANOVA for repeated measures without
// correction, then Bonferroni with the pooled error; else Friedman (exact where possible), then Dunn. Where K2
// cannot judge (fewer than eight subjects) normality is not shown, so ranks decide. Experiment 2: one-way ANOVA,
// then Bonferroni. Without trials there is nothing but a problem.
MeasureAnalysis analyse_measure(const StudyColumns& columns, Metric metric, AnalysisKind kind);

// The measures the paper reports of an experiment: penetration and time; of experiment 2 peak displacement.
std::vector<Metric> measures_of(std::uint32_t experiment);

// All measures of all experiments that have trials, by experiment.
std::vector<MeasureAnalysis> analyse_trials(const std::vector<TrialRow>& rows, AnalysisKind kind);

// The finding in words with its numbers: the test, the order of the means, each pair, and (full) whether the
// other tests agree.
std::string finding_text(const MeasureAnalysis& measure);
// The test, the order of the means, and which pairs differ.
std::string finding_in_brief(const MeasureAnalysis& measure);
// In how many trials, of how many subjects, the needle oscillated, per modality.
std::string stability_text(const StudyColumns& columns);

// Tests, columns and pairs of these measures, as shown to people. Those of one kind and one experiment.
std::vector<ReportTable> analysis_tables(const std::vector<MeasureAnalysis>& measures);

// An object `analysis`, `level`, `measures`; SI units; what was refused is null or missing.
nlohmann::ordered_json to_json(const std::vector<MeasureAnalysis>& measures, AnalysisKind kind);

}  // namespace thimble
