#include "analysis/statistics/pairwise.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/statistics/anova.hpp"
#include "analysis/statistics/descriptive.hpp"
#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/named_values.hpp"
#include "common/error.hpp"

namespace thimble {
namespace {

struct Difference {
    double mean;
    double standard_error;
    double df;
};

ConfidenceInterval around(const Difference& difference, double confidence) {
    const double half = t_half_width(confidence, difference.df) * difference.standard_error;
    return {difference.mean - half, difference.mean + half};
}

// `family`: all pairs, also those that could not be tested.
void adjust(std::vector<MeanPair>& pairs, std::size_t family) {
    std::vector<double> p(family, 1);
    std::transform(pairs.begin(), pairs.end(), p.begin(), [](const MeanPair& pair) { return pair.p; });
    const std::vector<double> by_bonferroni = bonferroni(p);
    const std::vector<double> by_holm = holm(p);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        pairs[i].p_bonferroni = by_bonferroni[i];
        pairs[i].p_holm = by_holm[i];
    }
}

MeanPair pair_of(std::size_t first, std::size_t second, const Difference& difference, double confidence,
                 std::size_t family) {
    MeanPair pair;
    pair.first = first;
    pair.second = second;
    pair.difference = difference.mean;
    pair.interval = around(difference, confidence);
    pair.interval_simultaneous = around(difference, 1 - (1 - confidence) / static_cast<double>(family));
    pair.t = difference.mean / difference.standard_error;
    pair.df = difference.df;
    pair.p = t_two_sided(pair.t, pair.df);
    return pair;
}

std::size_t pairs_of(std::size_t conditions) { return conditions * (conditions - 1) / 2; }

// each(first, second) for each of the pairs of `conditions`.
template <class Each>
void for_all_pairs(std::size_t conditions, const Each& each) {
    for (std::size_t first = 0; first + 1 < conditions; ++first) {
        for (std::size_t second = first + 1; second < conditions; ++second) each(first, second);
    }
}

// difference(first, second) of each of the pairs of `conditions`.
template <class DifferenceOf>
std::vector<MeanPair> all_pairs(std::size_t conditions, double confidence,
                                const DifferenceOf& difference_of) {
    const std::size_t family = pairs_of(conditions);
    std::vector<MeanPair> pairs;
    for_all_pairs(conditions, [&](std::size_t first, std::size_t second) {
        pairs.push_back(pair_of(first, second, difference_of(first, second), confidence, family));
    });
    adjust(pairs, family);
    return pairs;
}

void require_probabilities(const std::vector<double>& p) {
    for (const double value : p) {
        if (value >= 0 && value <= 1) continue;
        refuse("adjustment of P values", "P = " + std::to_string(value) + " is not in [0, 1]");
    }
}

}  // namespace

std::vector<MeanPair> pairs_after_repeated_anova(const SampleTable& table, double confidence) {
    require_confidence(confidence, "pairs after repeated-measures ANOVA");
    const RepeatedAnova anova = repeated_anova(table);
    const double standard_error = std::sqrt(2 * anova.ms_error() / static_cast<double>(table.subjects()));
    return all_pairs(table.conditions(), confidence, [&](std::size_t first, std::size_t second) {
        const Moments m = paired_differences(table.column(first), table.column(second)).moments;
        return Difference{m.mean, standard_error, anova.df_error};
    });
}

PairedTests paired_t_tests(const SampleTable& table, double confidence) {
    constexpr const char* kWhat = "paired t tests";
    require_confidence(confidence, kWhat);
    table.require_shape(2, 2, kWhat);
    const std::size_t family = pairs_of(table.conditions());
    PairedTests tests;
    for_all_pairs(table.conditions(), [&](std::size_t first, std::size_t second) {
        try {
            const Moments m = spread_differences(table.column(first), table.column(second), kWhat);
            const auto n = static_cast<double>(m.n);
            const Difference difference{m.mean, std::sqrt(m.variance() / n), n - 1};
            tests.pairs.push_back(pair_of(first, second, difference, confidence, family));
        } catch (const Error& refused) {
            tests.refused.emplace_back(refused.what());
        }
    });
    if (tests.pairs.empty()) throw Error(ExitCode::kData, tests.refused.front());
    adjust(tests.pairs, family);
    return tests;
}

std::vector<MeanPair> pairs_after_one_way_anova(const std::vector<NamedValues>& groups, double confidence) {
    require_confidence(confidence, "pairs after one-way ANOVA");
    const OneWayAnova anova = one_way_anova(groups);
    return all_pairs(groups.size(), confidence, [&](std::size_t first, std::size_t second) {
        const Moments a = moments(groups[first].values);
        const Moments b = moments(groups[second].values);
        const double parts = 1 / static_cast<double>(a.n) + 1 / static_cast<double>(b.n);
        return Difference{mean_difference(a, b), std::sqrt(anova.ms_within() * parts), anova.df_within};
    });
}

std::vector<double> bonferroni(const std::vector<double>& p) {
    require_probabilities(p);
    std::vector<double> adjusted;
    adjusted.reserve(p.size());
    for (const double value : p) adjusted.push_back(std::min(1.0, static_cast<double>(p.size()) * value));
    return adjusted;
}

std::vector<double> holm(const std::vector<double>& p) {
    require_probabilities(p);
    std::vector<std::size_t> order(p.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
    std::vector<double> adjusted(p.size());
    double largest = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        largest = std::max(largest, std::min(1.0, static_cast<double>(p.size() - i) * p[order[i]]));
        adjusted[order[i]] = largest;
    }
    return adjusted;
}

}  // namespace thimble
