#include "experiment/statistics/pairwise.hpp"

#include <cmath>

#include "experiment/statistics/adjustment.hpp"
#include "experiment/statistics/anova.hpp"
#include "experiment/statistics/distributions.hpp"
#include "experiment/statistics/moments.hpp"
#include "experiment/statistics/paired_differences.hpp"

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

void adjust(std::vector<MeanPair>& pairs) {
    std::vector<double> p;
    p.reserve(pairs.size());
    for (const MeanPair& pair : pairs) p.push_back(pair.p);
    const std::vector<double> by_bonferroni = bonferroni(p);
    const std::vector<double> by_holm = holm(p);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        pairs[i].p_bonferroni = by_bonferroni[i];
        pairs[i].p_holm = by_holm[i];
    }
}

// difference(first, second) of each of the pairs of `conditions`.
template <class DifferenceOf>
std::vector<MeanPair> all_pairs(std::size_t conditions, double confidence,
                                const DifferenceOf& difference_of) {
    const std::size_t count = conditions * (conditions - 1) / 2;
    const auto family = static_cast<double>(count);
    std::vector<MeanPair> pairs;
    for (std::size_t first = 0; first + 1 < conditions; ++first) {
        for (std::size_t second = first + 1; second < conditions; ++second) {
            const Difference difference = difference_of(first, second);
            MeanPair pair;
            pair.first = first;
            pair.second = second;
            pair.difference = difference.mean;
            pair.interval = around(difference, confidence);
            pair.interval_simultaneous = around(difference, 1 - (1 - confidence) / family);
            pair.t = difference.mean / difference.standard_error;
            pair.df = difference.df;
            pair.p = t_two_sided(pair.t, pair.df);
            pairs.push_back(pair);
        }
    }
    adjust(pairs);
    return pairs;
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

std::vector<MeanPair> paired_t_tests(const SampleTable& table, double confidence) {
    constexpr const char* kWhat = "paired t tests";
    require_confidence(confidence, kWhat);
    table.require_shape(2, 2, kWhat);
    return all_pairs(table.conditions(), confidence, [&](std::size_t first, std::size_t second) {
        const Moments m = spread_differences(table.column(first), table.column(second), kWhat);
        const auto n = static_cast<double>(m.n);
        return Difference{m.mean, std::sqrt(m.variance() / n), n - 1};
    });
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

}  // namespace thimble
