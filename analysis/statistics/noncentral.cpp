#include "analysis/statistics/noncentral.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <boost/math/tools/toms748_solve.hpp>

#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/named_values.hpp"

namespace thimble {
namespace {

constexpr const char* kNoncentralInterval = "confidence interval from a noncentral distribution";
constexpr int kDoublings = 100;

using RootInDouble = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

// The root of a rising function between two points of opposite sign.
template <class Function>
double root(const Function& function, double low, double high) {
    const double at_low = function(low);
    const double at_high = function(high);
    if (at_low == 0) return low;
    if (at_high == 0) return high;
    if (at_low > 0 || at_high < 0)
        refuse(kNoncentralInterval, "no bound found; check the data for extreme values");
    const boost::math::tools::eps_tolerance<double> tolerance(50);
    std::uintmax_t evaluations = 200;
    const auto [below, above] = boost::math::tools::toms748_solve(function, low, high, at_low, at_high,
                                                                  tolerance, evaluations, RootInDouble());
    return below + (above - below) / 2;
}

// Where the rising function of delta crosses zero; looked for around t, in ever wider steps.
template <class Function>
double root_around(const Function& function, double t, double step) {
    double low = t - step;
    double high = t + step;
    for (int i = 0; i < kDoublings && function(low) > 0; ++i) low -= step *= 2;
    for (int i = 0; i < kDoublings && function(high) < 0; ++i) high += step *= 2;
    return root(function, low, high);
}

// From zero upwards; zero if the function is not negative there.
template <class Function>
double root_from_zero(const Function& function, double step) {
    if (!(function(0.0) < 0)) return 0;
    double high = step;
    for (int i = 0; i < kDoublings && function(high) < 0; ++i) high *= 2;
    return root(function, 0, high);
}

}  // namespace

ConfidenceInterval noncentrality_of_t(double t, double df, double confidence) {
    require_confidence(confidence, kNoncentralInterval);
    const double tail = (1 - confidence) / 2;
    // P(T >= t) rises with delta, P(T <= t) falls: each bound is solved for its own small tail.
    const auto low = [&](double delta) { return noncentral_t_upper(t, df, delta) - tail; };
    const auto high = [&](double delta) { return tail - noncentral_t_lower(t, df, delta); };
    const double step = 1 + std::abs(t) / std::sqrt(df);
    return {root_around(low, t, step), root_around(high, t, step)};
}

ConfidenceInterval noncentrality_of_f(double f, double df_1, double df_2, double confidence) {
    require_confidence(confidence, kNoncentralInterval);
    const double tail = (1 - confidence) / 2;
    const auto low = [&](double lambda) { return noncentral_f_upper(f, df_1, df_2, lambda) - tail; };
    const auto high = [&](double lambda) { return tail - noncentral_f_lower(f, df_1, df_2, lambda); };
    const double step = 1 + f * df_1;
    return {root_from_zero(low, step), root_from_zero(high, step)};
}

}  // namespace thimble
