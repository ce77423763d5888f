#include "netem/stages/delay_shape.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/gamma.hpp>

#include "common/math/portable.hpp"
#include "common/math/real.hpp"
#include "netem/jitter_table.hpp"

namespace thimble {
namespace {

using portable::InReal;
using portable::Real;

constexpr double kSqrtHalf = 0.5 * std::numbers::sqrt2;
double above(double z) { return 0.5 * static_cast<double>(boost::math::erfc(Real(z * kSqrtHalf), InReal())); }
double below(double z) { return above(-z); }

// Index 3: x^-3 of all lie above x >= 1. Mean 3/2, variance 3/4.
double pareto(double share_above) {
    constexpr double kPerStandardDeviation = 2 * std::numbers::inv_sqrt3;
    return (1 / portable::cbrt(share_above) - 1.5) * kPerStandardDeviation;
}

// Both parts of one packet at the same quantile, as in iproute2's paretonormal.c, but scaled to a standard
// deviation of 1: variance 1/16 + 9/16 + 2 (1/4) (3/4) r, where r is the covariance of the two quantile functions
// (the integral of their product over (0, 1), here to 16 digits).
double pareto_normal(double z) {
    constexpr double kCovariance = 0.6783527895499958;
    static const double per_standard_deviation = 1 / std::sqrt(0.625 + 0.375 * kCovariance);
    return (0.25 * z + 0.75 * pareto(above(z))) * per_standard_deviation;
}

// Table of the gamma shape: a standard normal number beyond +-8.5 comes once in 10^16.
constexpr double kReach = 8.5;
constexpr int kCells = 512;
constexpr double kCell = 2 * kReach / kCells;
// Above, the shape is normal but for a skewness of 2 / sqrt(k) < 0.0002 (two terms of Cornish and Fisher 1938).
constexpr double kNearlyNormal = 1e8;

double gamma_quantile(double k, double z) {
    const Real quantile = z < 0 ? boost::math::gamma_p_inv(Real(k), Real(below(z)), InReal())
                                : boost::math::gamma_q_inv(Real(k), Real(above(z)), InReal());
    return static_cast<double>(quantile);
}

// dG/dz = phi(z) / f(G), f(G) = G^(k-1) exp(-G) / Gamma(k).
double gamma_slope(double k, double z, double quantile) {
    if (quantile <= 0) return 0;
    const double log_normal = -0.5 * z * z - 0.5 * portable::log(2 * std::numbers::pi);
    const double log_density = (k - 1) * portable::log(quantile) - quantile -
                               static_cast<double>(boost::math::lgamma(Real(k), InReal()));
    return portable::exp(log_normal - log_density);
}

}  // namespace

DelayShape::DelayShape(const JitterSettings& settings, Duration delay)
    : shape_(settings.shape), table_(settings.table) {
    assert(shape_ != JitterShape::kTable || table_ != nullptr);
    if (shape_ != JitterShape::kGamma) return;
    if (delay <= Duration::zero() || settings.spread <= Duration::zero()) {
        shape_ = JitterShape::kNone;  // who never comes before time 0 and at 0 on average comes at 0
        return;
    }
    const double ratio = to_seconds(delay) / to_seconds(settings.spread);
    const double k = ratio * ratio;
    for (int i = 0; i <= kCells; ++i) {
        const double z = -kReach + i * kCell;
        if (k > kNearlyNormal) {
            nodes_.push_back({z + (z * z - 1) / (3 * ratio), 1 + 2 * z / (3 * ratio)});
            continue;
        }
        const double quantile = gamma_quantile(k, z);
        nodes_.push_back({(quantile - k) / ratio, gamma_slope(k, z, quantile) / ratio});
    }
}

bool DelayShape::takes_normal() const {
    return shape_ == JitterShape::kNormal || shape_ == JitterShape::kGamma ||
           shape_ == JitterShape::kParetoNormal;
}

// Cubic Hermite between the nodes.
double DelayShape::gamma(double z) const {
    const double position = (std::clamp(z, -kReach, kReach) + kReach) / kCell;
    const int cell = std::min(static_cast<int>(position), kCells - 1);
    const double t = position - cell;
    const Node& a = nodes_[static_cast<std::size_t>(cell)];
    const Node& b = nodes_[static_cast<std::size_t>(cell) + 1];
    const double rise = b.deviate - a.deviate;
    const double from_a = a.slope * kCell - rise;
    const double from_b = rise - b.slope * kCell;
    return a.deviate + t * rise + t * (1 - t) * ((1 - t) * from_a + t * from_b);
}

double DelayShape::at_normal(double z) const {
    switch (shape_) {
        case JitterShape::kNone:
            return 0;
        case JitterShape::kUniform:
            return static_cast<double>(boost::math::erf(Real(z * kSqrtHalf), InReal()));
        case JitterShape::kNormal:
            return z;
        case JitterShape::kGamma:
            return gamma(z);
        case JitterShape::kPareto:
            return pareto(above(z));
        case JitterShape::kParetoNormal:
            return pareto_normal(z);
        case JitterShape::kTable:
            return table_->quantile(below(z));
    }
    return 0;
}

double DelayShape::at_uniform(double u) const {
    assert(!takes_normal());
    switch (shape_) {
        case JitterShape::kUniform:
            return -1.0 + 2.0 * u;
        case JitterShape::kPareto:
            return pareto(1 - u);
        case JitterShape::kTable:
            return table_->quantile(u);
        default:
            return 0;
    }
}

}  // namespace thimble
