#include "analysis/statistics/friedman.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/friedman_exact.hpp"
#include "analysis/statistics/ranks.hpp"

namespace thimble {
namespace {

constexpr const char* kFriedman = "Friedman test";

// Everything in doubled ranks, so that it is whole and exact.
struct RankedTable {
    std::vector<std::vector<std::int64_t>> rows;
    std::vector<std::int64_t> sums;    // per condition
    std::int64_t spread_of_sums = 0;   // sum_j (R_j - n (k + 1))^2
    std::int64_t spread_of_ranks = 0;  // sum_ij (r_ij - (k + 1))^2
};

RankedTable rank(const SampleTable& table) {
    const auto k = static_cast<std::int64_t>(table.conditions());
    const auto n = static_cast<std::int64_t>(table.subjects());
    RankedTable ranked;
    ranked.sums.assign(table.conditions(), 0);
    for (std::size_t s = 0; s < table.subjects(); ++s) {
        ranked.rows.push_back(doubled_ranks(table.row(s)));
        for (std::size_t c = 0; c < table.conditions(); ++c) {
            const std::int64_t rank = ranked.rows.back()[c];
            ranked.sums[c] += rank;
            ranked.spread_of_ranks += (rank - (k + 1)) * (rank - (k + 1));
        }
    }
    for (const std::int64_t sum : ranked.sums) {
        ranked.spread_of_sums += (sum - n * (k + 1)) * (sum - n * (k + 1));
    }
    return ranked;
}

RankedTable checked_ranks(const SampleTable& table) {
    table.require_shape(2, 2, kFriedman);
    RankedTable ranked = rank(table);
    if (ranked.spread_of_ranks == 0) {
        refuse(kFriedman, "every subject has the same value in all columns ('" + table.name(0) +
                              "' ...), so there is no order to test; check where the values come from");
    }
    return ranked;
}

std::vector<double> mean_ranks(const RankedTable& ranked) {
    std::vector<double> means;
    for (const std::int64_t sum : ranked.sums) {
        means.push_back(static_cast<double>(sum) / static_cast<double>(2 * ranked.rows.size()));
    }
    return means;
}

}  // namespace

Friedman friedman(const SampleTable& table) {
    const RankedTable ranked = checked_ranks(table);
    Friedman result;
    result.df = static_cast<double>(table.conditions() - 1);
    result.chi_squared =
        result.df * static_cast<double>(ranked.spread_of_sums) / static_cast<double>(ranked.spread_of_ranks);
    result.p_asymptotic = chi_squared_upper(result.chi_squared, result.df);
    result.p_exact = friedman_exact_p(ranked.rows, ranked.spread_of_sums, kFriedmanExactSteps);
    result.kendalls_w = result.chi_squared / (static_cast<double>(table.subjects()) * result.df);
    result.mean_ranks = mean_ranks(ranked);
    return result;
}

std::vector<DunnPair> dunn_after_friedman(const SampleTable& table) {
    const std::vector<double> means = mean_ranks(checked_ranks(table));
    const auto k = static_cast<double>(means.size());
    const double standard_error = std::sqrt(k * (k + 1) / (6 * static_cast<double>(table.subjects())));
    const double family = k * (k - 1) / 2;
    std::vector<DunnPair> pairs;
    for (std::size_t first = 0; first + 1 < means.size(); ++first) {
        for (std::size_t second = first + 1; second < means.size(); ++second) {
            DunnPair pair{first, second, means[first] - means[second]};
            pair.z = std::abs(pair.mean_rank_difference) / standard_error;
            pair.p = normal_two_sided(pair.z);
            pair.p_adjusted = std::min(1.0, family * pair.p);
            pairs.push_back(pair);
        }
    }
    return pairs;
}

}  // namespace thimble
