#include "analysis/statistics/normality.hpp"

#include <cmath>

#include <boost/math/special_functions/asinh.hpp>

#include "analysis/statistics/descriptive.hpp"
#include "analysis/statistics/distributions.hpp"
#include "common/math/portable.hpp"
#include "common/math/real.hpp"

namespace thimble {
namespace {

constexpr const char* kNormality = "D'Agostino-Pearson test of normality";
constexpr std::size_t kLeast = 8;

// D'Agostino 1970. Odd in the skewness: symmetric data give exactly 0.
double z_of_skewness(double skewness, double n) {
    const double y = skewness * std::sqrt((n + 1) * (n + 3) / (6 * (n - 2)));
    const double beta_2 =
        3 * (n * n + 27 * n - 70) * (n + 1) * (n + 3) / ((n - 2) * (n + 5) * (n + 7) * (n + 9));
    const double w_squared = -1 + std::sqrt(2 * (beta_2 - 1));
    const double delta = 1 / std::sqrt(0.5 * portable::log(w_squared));
    const double alpha = std::sqrt(2 / (w_squared - 1));
    return delta * static_cast<double>(boost::math::asinh(portable::Real(y / alpha), portable::InReal()));
}

// Anscombe and Glynn 1983.
double z_of_kurtosis(double kurtosis, double n, const std::string& name) {
    const double expected = 3 * (n - 1) / (n + 1);
    const double variance = 24 * n * (n - 2) * (n - 3) / ((n + 1) * (n + 1) * (n + 3) * (n + 5));
    const double x = (kurtosis - expected) / std::sqrt(variance);
    const double root_beta_1 = 6 * (n * n - 5 * n + 2) / ((n + 7) * (n + 9)) *
                               std::sqrt(6 * (n + 3) * (n + 5) / (n * (n - 2) * (n - 3)));
    const double a = 6 + 8 / root_beta_1 * (2 / root_beta_1 + std::sqrt(1 + 4 / (root_beta_1 * root_beta_1)));
    // Not positive only near the least kurtosis there is, 1 (two values, equally often), from n = 35 on.
    const double denominator = 1 + x * std::sqrt(2 / (a - 4));
    if (!(denominator > 0)) {
        refuse(kNormality,
               "column '" + name + "' has a kurtosis of " + std::to_string(kurtosis) +
                   ", flatter than the approximation reaches (two values only?); it is not normal");
    }
    const double term = portable::cbrt((1 - 2 / a) / denominator);
    return (1 - 2 / (9 * a) - term) / std::sqrt(2 / (9 * a));
}

}  // namespace

Normality normality(const NamedValues& column) {
    require_numbers(column, kNormality);
    require_at_least(column, kLeast, kNormality);
    const Moments m = moments(column.values);
    if (at_rounding(m))
        refuse(kNormality,
               "column '" + column.name +
                   "' is constant, so there is no spread to judge by; check where its values come from");
    const auto n = static_cast<double>(m.n);
    const double scale = std::sqrt(m.squares / n);
    Normality result;
    for (const double value : column.values) {
        const double z = deviation(value, m) / scale;
        result.skewness += z * z * z / n;
        result.kurtosis += z * z * z * z / n;
    }
    result.z_skewness = z_of_skewness(result.skewness, n);
    result.z_kurtosis = z_of_kurtosis(result.kurtosis, n, column.name);
    result.k2 = result.z_skewness * result.z_skewness + result.z_kurtosis * result.z_kurtosis;
    result.p = chi_squared_upper(result.k2, 2);
    return result;
}

}  // namespace thimble
