#include "analysis/statistics/mixed_model.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "analysis/statistics/cholesky.hpp"
#include "analysis/statistics/distributions.hpp"
#include "common/math/portable.hpp"

namespace thimble {
namespace {

constexpr const char* kMixedModel = "linear mixed model";
// The ratio of the standard deviations is sought up to here; its precision is relative.
constexpr double kLargestRatio = 1e4, kPrecision = 1e-10;

// Rows of one group, with the value as a last column.
struct GroupSums {
    double n = 0;
    std::vector<double> sums;  // of each column
};

class RestrictedLikelihood {
  public:
    RestrictedLikelihood(const NamedValues& values, const std::vector<NamedValues>& columns,
                         const std::vector<std::size_t>& group)
        : p_(columns.size()), n_(values.values.size()), squares_((p_ + 1) * (p_ + 1)) {
        std::map<std::size_t, GroupSums> groups;
        std::vector<double> row(p_ + 1);
        for (std::size_t i = 0; i < n_; ++i) {
            for (std::size_t k = 0; k < p_; ++k) row[k] = columns[k].values[i];
            row[p_] = values.values[i];
            GroupSums& own = groups[group[i]];
            ++own.n;
            own.sums.resize(p_ + 1);
            for (std::size_t a = 0; a <= p_; ++a) {
                own.sums[a] += row[a];
                for (std::size_t b = 0; b <= p_; ++b) squares_[a * (p_ + 1) + b] += row[a] * row[b];
            }
        }
        groups_.reserve(groups.size());
        for (auto& [name, sums] : groups) groups_.push_back(std::move(sums));
    }

    struct Solution {
        std::vector<double> b;
        std::optional<Cholesky> information;  // X' V^-1 X, V in units of the rest's variance
        double variance_rest = 0, log_likelihood = 0;
    };

    // `ratio` of the standard deviations, group over rest. V^-1 = 1 - r / (1 + r n) 11' in each group, r = ratio squared.
    Solution at(double ratio) const {
        const double r = ratio * ratio;
        std::vector<double> all = squares_;
        double log_determinant = 0;
        for (const GroupSums& group : groups_) {
            const double less = r / (1 + r * group.n);
            for (std::size_t a = 0; a <= p_; ++a)
                for (std::size_t b = 0; b <= p_; ++b)
                    all[a * (p_ + 1) + b] -= less * group.sums[a] * group.sums[b];
            log_determinant += portable::log1p(r * group.n);
        }
        Solution solution = solve(all);
        const auto left = static_cast<double>(n_ - p_);
        solution.log_likelihood =
            -0.5 * (log_determinant + solution.information->log_determinant() +
                    left * (1 + portable::log(2 * std::numbers::pi * solution.variance_rest)));
        return solution;
    }

  private:
    Solution solve(const std::vector<double>& all) const {
        std::vector<double> matrix(p_ * p_);
        Solution solution;
        solution.b.resize(p_);
        for (std::size_t a = 0; a < p_; ++a) {
            for (std::size_t b = 0; b < p_; ++b) matrix[a * p_ + b] = all[a * (p_ + 1) + b];
            solution.b[a] = all[a * (p_ + 1) + p_];
        }
        const std::vector<double> products = solution.b;
        solution.information = Cholesky::of(std::move(matrix), p_);
        if (!solution.information)
            refuse(kMixedModel, "its columns depend on each other; leave one of them out");
        solution.information->solve(solution.b);
        const double explained =
            std::inner_product(products.begin(), products.end(), solution.b.begin(), 0.0);
        solution.variance_rest = (all.back() - explained) / static_cast<double>(n_ - p_);
        if (!(solution.variance_rest > 0))
            refuse(kMixedModel, "the columns explain every value; nothing is left");
        return solution;
    }

    std::size_t p_, n_;
    std::vector<double> squares_;  // of the columns and the value: X' X, X' y, y' y
    std::vector<GroupSums> groups_;
};

// Golden section in x = ratio / (1 + ratio), where the likelihood has one maximum.
double best_ratio(const RestrictedLikelihood& likelihood) {
    const auto ratio = [](double x) { return x / (1 - x); };
    const auto value = [&](double x) { return likelihood.at(ratio(x)).log_likelihood; };
    const double shrink = 2 / (1 + std::sqrt(5.0));
    double low = 0, high = kLargestRatio / (1 + kLargestRatio);
    double a = high - shrink * (high - low), b = low + shrink * (high - low);
    double at_a = value(a), at_b = value(b);
    while (high - low > kPrecision) {
        if (at_a < at_b) {
            low = std::exchange(a, b);
            at_a = at_b;
            b = low + shrink * (high - low);
            at_b = value(b);
        } else {
            high = std::exchange(b, a);
            at_b = at_a;
            a = high - shrink * (high - low);
            at_a = value(a);
        }
    }
    const double x = 0.5 * (low + high);
    return value(0) >= value(x) ? 0 : ratio(x);
}

void require_shape(const NamedValues& values, const std::vector<NamedValues>& columns,
                   const std::vector<std::size_t>& group) {
    require_numbers(values, kMixedModel);
    require_at_least(values, columns.size() + 2, kMixedModel);
    if (columns.empty()) refuse(kMixedModel, "has no column; give an intercept at least");
    for (const NamedValues& column : columns) {
        require_numbers(column, kMixedModel);
        if (column.values.size() != values.values.size())
            refuse(kMixedModel, "column '" + column.name + "' has another length than the values");
    }
    std::vector<std::size_t> names = group;
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    if (group.size() != values.values.size()) refuse(kMixedModel, "a value has no group");
    if (names.size() < 2 || names.size() == group.size())
        refuse(kMixedModel, "needs two groups or more, and groups with several values");
}

}  // namespace

MixedModel mixed_model(const NamedValues& values, const std::vector<NamedValues>& columns,
                       const std::vector<std::size_t>& group) {
    require_shape(values, columns, group);
    const RestrictedLikelihood likelihood(values, columns, group);
    const double ratio = best_ratio(likelihood);
    const auto solution = likelihood.at(ratio);
    MixedModel model;
    model.variance_rest = solution.variance_rest;
    model.variance_group = ratio * ratio * solution.variance_rest;
    model.log_likelihood = solution.log_likelihood;
    const double half = normal_quantile(0.975);
    for (std::size_t k = 0; k < columns.size(); ++k) {
        std::vector<double> unit(columns.size());
        unit[k] = 1;
        solution.information->solve(unit);
        FixedEffect effect{
            columns[k].name, solution.b[k], std::sqrt(unit[k] * solution.variance_rest), 0, 1, {}};
        effect.z = effect.estimate / effect.standard_error;
        effect.p = normal_two_sided(effect.z);
        effect.interval = {effect.estimate - half * effect.standard_error,
                           effect.estimate + half * effect.standard_error};
        model.effects.push_back(std::move(effect));
    }
    return model;
}

}  // namespace thimble
