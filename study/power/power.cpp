#include "study/power/power.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "analysis/findings.hpp"
#include "analysis/statistics/descriptive.hpp"
#include "analysis/tables/study_columns.hpp"
#include "common/process/progress.hpp"
#include "common/random.hpp"
#include "session/settings/protocol.hpp"
#include "study/study.hpp"

namespace thimble {
namespace {

constexpr std::array<std::size_t, 12> kSubjectGrid{6,  8,  10, 12, 16, 20,
                                                   24, 32, 40, 60, 80, kMostPowerSubjects};
constexpr double kCertain = 0.995;         // beyond it a curve is flat
constexpr std::uint32_t kPowerStream = 3;  // the stream's experiment; fits have 1 and 2

std::vector<TrialRow> first_trials(const std::vector<TrialRow>& rows, std::uint32_t trials) {
    std::map<std::pair<std::uint32_t, Modality>, std::uint32_t> seen;
    std::vector<TrialRow> kept;
    for (const TrialRow& row : rows)
        if (++seen[{row.conditions.subject, row.conditions.modality}] <= trials) kept.push_back(row);
    return kept;
}

bool comes_out(const NamedValues& study, const PowerPair& pair) {
    if (study.values.size() < fewest_for_signed_rank(pair.family, kFindingLevel)) return false;
    const LocationShift shift = signed_rank(study, pair.family, kFindingLevel);
    if (!pair.precision) return shift.p < kFindingLevel;
    return shift.interval && shift.interval->high - shift.interval->low <= 2 * *pair.precision;
}

// The fewest subjects. `curve` gets what was computed on the way, up to where it is flat; without it the search ends sooner.
std::optional<std::size_t> fewest_subjects(const PowerPair& pair, const PowerOptions& options,
                                           std::vector<std::pair<std::size_t, double>>* curve) {
    std::optional<std::size_t> enough;
    std::size_t before = 1;
    for (const std::size_t n : kSubjectGrid) {
        const double share = share_of_studies(pair, n, options);
        if (curve != nullptr) curve->emplace_back(n, share);
        if (!enough && share >= options.power) enough = n;
        if (!enough) before = n;
        if (share >= kCertain || (enough && curve == nullptr)) break;
    }
    if (!enough) return enough;
    while (*enough - before > 1) {
        const std::size_t middle = (before + *enough) / 2;
        (share_of_studies(pair, middle, options) >= options.power ? *enough : before) = middle;
    }
    return enough;
}

class PowerPlan {
  public:
    PowerPlan(const SystemSettings& settings, const PowerOptions& options)
        : settings_(settings), options_(options) {}

    PowerResult run() {
        for (const double delay_s : options_.delays_s) {
            if (!run_pool(delay_s)) break;
            compare(delay_s);
        }
        return std::move(result_);
    }

  private:
    bool run_pool(double delay_s) {
        Protocol protocol = experiment_3(settings_, options_.pool, options_.seed);
        protocol.delay_s = delay_s;
        protocol.trials_per_modality = options_.trials;
        const std::vector<TrialConditions> trials = all_trials({protocol});
        rows_.clear();
        rows_.reserve(trials.size());
        result_.complete = run_trials(
            settings_, trials, thread_count(options_.jobs), options_.stop, [&](const TrialRecord& record) {
                rows_.push_back(make_row(record));
                progress_.count(rows_.size(), trials.size(), "trials", delay_text(delay_s));
            });
        return result_.complete;
    }

    // Fewer trials of each subject are the first ones.
    void compare(double delay_s) {
        const std::size_t first = result_.comparisons.size();
        for (std::uint32_t trials = options_.trials; trials > 0; trials /= 2) {
            const StudyColumns columns(first_trials(rows_, trials), 3, delay_s);
            std::size_t at = first;
            for (const Metric metric : measures_of(3))
                if (options_.judges(metric)) compare(columns, metric, trials, at);
        }
        for (std::size_t i = first; i < result_.comparisons.size(); ++i)
            result_.comparisons[i].delay_s = delay_s;
    }

    void compare(const StudyColumns& columns, Metric metric, std::uint32_t trials, std::size_t& at) {
        const std::vector<NamedValues> means = columns.subject_means(metric);
        for (std::size_t a = 0; a < means.size(); ++a) {
            for (std::size_t b = a + 1; b < means.size(); ++b, ++at) {
                const bool all = trials == options_.trials;
                if (all)
                    result_.comparisons.push_back({metric, means[a].name, means[b].name, 0, {}, 0, {}, {}});
                judge(pair_of(means[a], means[b], metric), trials, all, result_.comparisons.at(at));
            }
        }
    }

    PowerPair pair_of(const NamedValues& first, const NamedValues& second, Metric metric) const {
        const std::size_t modalities = kModalities.size();
        PowerPair pair{{first.name + " - " + second.name, {}},
                       modalities * (modalities - 1) / 2,
                       options_.precision_of(metric)};
        pair.differences.values.reserve(options_.pool);
        for (std::size_t i = 0; i < first.values.size(); ++i)
            pair.differences.values.push_back(first.values[i] - second.values[i]);
        // The columns lack subjects of whom no trial ran to its end.
        pair.differences.values.resize(options_.pool, std::nan(""));
        return pair;
    }

    void judge(const PowerPair& pair, std::uint32_t trials, bool all, PowerComparison& comparison) const {
        auto& subjects = comparison.subjects[trials];
        NamedValues there = pair.differences;
        std::erase_if(there.values, [](double value) { return std::isnan(value); });
        if (all) comparison.with_a_value = there.values.size();
        if (there.values.empty()) return;
        if (all) comparison.difference = sample_median(there);
        subjects = fewest_subjects(pair, options_, all ? &comparison.curve : nullptr);
    }

    const SystemSettings& settings_;
    const PowerOptions& options_;
    std::vector<TrialRow> rows_;
    Progress progress_;
    PowerResult result_;
};

}  // namespace

double share_of_studies(const PowerPair& pair, std::size_t subjects, const PowerOptions& options) {
    if (subjects < fewest_for_signed_rank(pair.family, kFindingLevel)) return 0;
    RandomStream random(
        {options.seed, kPowerStream, static_cast<std::uint32_t>(subjects), 0, Purpose::kParameter});
    const std::vector<double>& pool = pair.differences.values;
    std::uint32_t out = 0;
    NamedValues study{pair.differences.name, {}};
    study.values.reserve(subjects);
    for (std::uint32_t i = 0; i < options.studies; ++i) {
        study.values.clear();
        for (std::size_t drawn = 0; drawn < subjects; ++drawn) {
            const double value = pool[random.below(static_cast<std::uint32_t>(pool.size()))];
            if (!std::isnan(value)) study.values.push_back(value);
        }
        out += comes_out(study, pair);
    }
    return static_cast<double>(out) / options.studies;
}

PowerResult plan_power(const SystemSettings& settings, const PowerOptions& options) {
    return PowerPlan(settings, options).run();
}

std::string name_of(const PowerComparison& comparison) {
    return fmt::format("{} - {}, {}, {}", comparison.first, comparison.second, name_of(comparison.metric),
                       delay_text(comparison.delay_s));
}

}  // namespace thimble
