#include "analysis/statistics/distributions.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <numbers>
#include <string>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

#include "analysis/statistics/named_values.hpp"
#include "common/math/real.hpp"

namespace thimble {
namespace {

using portable::InReal;
using portable::Real;

using Normal = boost::math::normal_distribution<Real, InReal>;
using StudentsT = boost::math::students_t_distribution<Real, InReal>;
using FisherF = boost::math::fisher_f_distribution<Real, InReal>;
using ChiSquared = boost::math::chi_squared_distribution<Real, InReal>;

// Boost's own words name its argument, but not whose statistic it was.
template <class Compute>
double evaluated(const char* what, const Compute& compute) {
    try {
        const auto result = static_cast<double>(compute());
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
                [&] { return boost::math::erfc(Real(std::abs(z) / std::numbers::sqrt2), InReal()); });
}

double normal_quantile(double p) {
    return evaluated("normal quantile", [&] { return quantile(Normal(), Real(p)); });
}

double t_upper(double t, double df) {
    return tail("t tail", [&] { return cdf(complement(StudentsT(df), Real(t))); });
}

double t_two_sided(double t, double df) { return std::min(1.0, 2 * t_upper(std::abs(t), df)); }

double t_half_width(double confidence, double df) {
    return evaluated("t quantile",
                     [&] { return quantile(complement(StudentsT(df), Real((1 - confidence) / 2))); });
}

double f_upper(double f, double df_1, double df_2) {
    return tail("F tail", [&] { return cdf(complement(FisherF(df_1, df_2), Real(f))); });
}

double f_quantile(double p, double df_1, double df_2) {
    return evaluated("F quantile", [&] { return quantile(FisherF(df_1, df_2), Real(p)); });
}

double chi_squared_upper(double x, double df) {
    return tail("chi-squared tail", [&] { return cdf(complement(ChiSquared(df), Real(x))); });
}

double chi_squared_quantile(double p, double df) {
    return evaluated("chi-squared quantile", [&] { return quantile(ChiSquared(df), Real(p)); });
}

}  // namespace thimble
