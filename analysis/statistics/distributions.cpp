#include "analysis/statistics/distributions.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <numbers>
#include <string>
#include <type_traits>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

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

}  // namespace thimble
