#include "analysis/statistics/mann_whitney.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/ranks.hpp"

namespace thimble {
namespace {

constexpr const char* kMannWhitney = "Mann-Whitney test";

// P(U <= u) with groups of n_1 and n_2, all orders equally likely. Ways to reach each U: the largest of all
// values is in the first group, and beats all n_2 of the second, or in the second and beats none.
double lower_tail(std::size_t n_1, std::size_t n_2, std::size_t u) {
    // p[i][w]: i values of the first group, j of the second (rolled over j), U = w.
    std::vector<std::vector<double>> p(n_1 + 1, std::vector<double>(n_1 * n_2 + 1, 0));
    for (auto& row : p) row[0] = 1;
    for (std::size_t j = 1; j <= n_2; ++j) {
        for (std::size_t i = 1; i <= n_1; ++i) {
            const double of_first = static_cast<double>(i) / static_cast<double>(i + j);
            const double of_second = static_cast<double>(j) / static_cast<double>(i + j);
            for (std::size_t w = i * j + 1; w-- > 0;) {
                p[i][w] = of_second * p[i][w] + (w >= j ? of_first * p[i - 1][w - j] : 0);
            }
        }
    }
    double sum = 0;
    for (std::size_t w = 0; w <= u; ++w) sum += p[n_1][w];
    return sum;
}

// `ties`: sum of t^3 - t over ties of t values.
double asymptotic(double u, double n_1, double n_2, double ties) {
    const double n = n_1 + n_2;
    const double variance = n_1 * n_2 / 12 * (n + 1 - ties / (n * (n - 1)));
    const double distance = std::max(0.0, std::abs(u - n_1 * n_2 / 2) - 0.5);
    return normal_two_sided(distance / std::sqrt(variance));
}

// `doubled_u`: 2 U of the first group, even without ties.
double exact(std::size_t n_1, std::size_t n_2, std::int64_t doubled_u) {
    const auto u = static_cast<std::size_t>(doubled_u / 2);
    return std::min(1.0, 2 * lower_tail(n_1, n_2, std::min(u, n_1 * n_2 - u)));
}

std::vector<double> joined(const NamedValues& first, const NamedValues& second) {
    std::vector<double> all = first.values;
    all.insert(all.end(), second.values.begin(), second.values.end());
    if (std::all_of(all.begin(), all.end(), [&](double value) { return value == all.front(); })) {
        refuse(kMannWhitney,
               "all values of '" + first.name + "' and '" + second.name +
                   "' are equal, so there is no order to test; check where the values come from");
    }
    return all;
}

}  // namespace

MannWhitney mann_whitney(const NamedValues& first, const NamedValues& second) {
    for (const NamedValues* group : {&first, &second}) {
        require_numbers(*group, kMannWhitney);
        require_at_least(*group, 1, kMannWhitney);
    }
    const std::vector<double> all = joined(first, second);
    const std::size_t n_1 = first.values.size();
    const std::size_t n_2 = second.values.size();
    const std::vector<std::int64_t> ranks = doubled_ranks(all);
    auto doubled_u = -static_cast<std::int64_t>(n_1 * (n_1 + 1));
    for (std::size_t i = 0; i < n_1; ++i) doubled_u += ranks[i];
    const double ties = tie_correction(all);
    MannWhitney result;
    result.u = static_cast<double>(doubled_u) / 2;
    result.superiority = result.u / static_cast<double>(n_1 * n_2);
    result.p_asymptotic = asymptotic(result.u, static_cast<double>(n_1), static_cast<double>(n_2), ties);
    if (ties == 0 && std::max(n_1, n_2) <= kMannWhitneyExact) result.p_exact = exact(n_1, n_2, doubled_u);
    return result;
}

}  // namespace thimble
