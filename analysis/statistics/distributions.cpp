#include "analysis/statistics/distributions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <numbers>
#include <string>
#include <type_traits>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/non_central_f.hpp>
#include <boost/math/distributions/non_central_t.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/tools/toms748_solve.hpp>

#include "analysis/statistics/named_values.hpp"

namespace thimble {
namespace {

namespace policies = boost::math::policies;
using InDouble = policies::policy<policies::promote_float<false>, policies::promote_double<false>>;
static_assert(std::is_same_v<policies::evaluation<double, InDouble>::type, double>);

using Normal = boost::math::normal_distribution<double, InDouble>;
using StudentsT = boost::math::students_t_distribution<double, InDouble>;
using FisherF = boost::math::fisher_f_distribution<double, InDouble>;
using ChiSquared = boost::math::chi_squared_distribution<double, InDouble>;
using NoncentralT = boost::math::non_central_t_distribution<double, InDouble>;
using NoncentralF = boost::math::non_central_f_distribution<double, InDouble>;

// Boost's own words name its argument, but not whose statistic it was.
template <class Compute>
double evaluated(const char* what, const Compute& compute) {
    try {
        const double result = compute();
        if (std::isfinite(result)) return result;
    } catch (const std::exception& error) {
        refuse(what,
               std::string("cannot be computed (") + error.what() + "); check the data for extreme values");
    }
    refuse(what, "is not a finite number; check the data for extreme values");
}

// Rounding of a sum may leave a tail one ulp outside.
template <class Compute>
double tail(const char* what, const Compute& compute) {
    return std::clamp(evaluated(what, compute), 0.0, 1.0);
}

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

double normal_two_sided(double z) {
    return tail("normal tail",
                [&] { return boost::math::erfc(std::abs(z) / std::numbers::sqrt2, InDouble()); });
}

double normal_quantile(double p) {
    return evaluated("normal quantile", [&] { return quantile(Normal(0, 1), p); });
}

double t_upper(double t, double df) {
    return tail("t tail", [&] { return cdf(complement(StudentsT(df), t)); });
}

double t_two_sided(double t, double df) { return std::min(1.0, 2 * t_upper(std::abs(t), df)); }

double t_half_width(double confidence, double df) {
    return evaluated("t quantile", [&] { return quantile(complement(StudentsT(df), (1 - confidence) / 2)); });
}

double f_upper(double f, double df_1, double df_2) {
    return tail("F tail", [&] { return cdf(complement(FisherF(df_1, df_2), f)); });
}

double chi_squared_upper(double x, double df) {
    return tail("chi-squared tail", [&] { return cdf(complement(ChiSquared(df), x)); });
}

double noncentral_t_upper(double t, double df, double noncentrality) {
    return tail("noncentral t tail", [&] { return cdf(complement(NoncentralT(df, noncentrality), t)); });
}

double noncentral_t_lower(double t, double df, double noncentrality) {
    return tail("noncentral t tail", [&] { return cdf(NoncentralT(df, noncentrality), t); });
}

// Boost 1.74 takes the wrong tail at a noncentrality of 0.
double noncentral_f_upper(double f, double df_1, double df_2, double noncentrality) {
    if (noncentrality == 0) return f_upper(f, df_1, df_2);
    return tail("noncentral F tail",
                [&] { return cdf(complement(NoncentralF(df_1, df_2, noncentrality), f)); });
}

double noncentral_f_lower(double f, double df_1, double df_2, double noncentrality) {
    return tail("noncentral F tail", [&] { return cdf(NoncentralF(df_1, df_2, noncentrality), f); });
}

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
