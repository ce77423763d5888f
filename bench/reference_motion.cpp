#include "bench/reference_motion.hpp"

namespace thimble {

namespace {

// The Taylor series is summed where the motion's rate times the time is below this; above, by squaring.
constexpr double kTaylorRate = 1.0 / 16;

}  // namespace

ReferenceHalving::ReferenceHalving(const ReferenceLaw& law, const ReferenceNumber& duration_s)
    : law_(law), duration_s_(duration_s) {
    const ReferenceNumber rate = (law.damping_per_s + law.natural_per_s) * duration_s;
    std::size_t squarings = 0;
    for (ReferenceNumber z = rate; z > kTaylorRate; z /= 2) ++squarings;
    levels_.resize(squarings + 1);
    levels_[squarings] = taylor(this->duration_s(squarings));
    for (std::size_t i = squarings; i > 0; --i) {
        const Exponential& half = levels_[i];
        levels_[i - 1] = {product(half.value, half.value),
                          sum(half.integral_s, product(half.value, half.integral_s))};
    }
}

ReferenceHalving::Matrix ReferenceHalving::product(const Matrix& a, const Matrix& b) {
    return {a.m00 * b.m00 + a.m01 * b.m10, a.m00 * b.m01 + a.m01 * b.m11, a.m10 * b.m00 + a.m11 * b.m10,
            a.m10 * b.m01 + a.m11 * b.m11};
}

ReferenceHalving::Matrix ReferenceHalving::sum(const Matrix& a, const Matrix& b) {
    return {a.m00 + b.m00, a.m01 + b.m01, a.m10 + b.m10, a.m11 + b.m11};
}

ReferenceHalving::Matrix ReferenceHalving::scaled(const Matrix& a, const ReferenceNumber& factor) {
    return {a.m00 * factor, a.m01 * factor, a.m10 * factor, a.m11 * factor};
}

// sum A^k t^k / k!  and  sum A^k t^(k+1) / (k+1)!
ReferenceHalving::Exponential ReferenceHalving::taylor(const ReferenceNumber& t_s) const {
    const Matrix a{0, 1, -law_.stiffness_per_s2, -law_.damping_per_s};
    // |A^k t^k| / k! in units of the motion's own speed.
    ReferenceNumber size = 1;
    const ReferenceNumber rate = 2 * (law_.damping_per_s + law_.natural_per_s) * t_s;
    const ReferenceNumber negligible = std::numeric_limits<ReferenceNumber>::epsilon() / 1000;
    Matrix term{1, 0, 0, 1};
    Exponential e{term, scaled(term, t_s)};
    for (int k = 1; size > negligible; ++k) {
        size *= rate / k;
        term = scaled(product(a, term), t_s / k);
        e.value = sum(e.value, term);
        e.integral_s = sum(e.integral_s, scaled(term, t_s / (k + 1)));
    }
    return e;
}

const ReferenceHalving::Exponential& ReferenceHalving::level(std::size_t halvings) {
    while (levels_.size() <= halvings) levels_.push_back(taylor(duration_s(levels_.size())));
    return levels_[halvings];
}

ReferenceMotion ReferenceHalving::advance(const ReferenceMotion& from, std::size_t halvings) {
    const Exponential& e = level(halvings);
    const ReferenceNumber& v = from.velocity_m_per_s;
    const ReferenceNumber& a = from.acceleration_m_per_s2;
    return {from.position_m + e.integral_s.m00 * v + e.integral_s.m01 * a, e.value.m00 * v + e.value.m01 * a,
            e.value.m10 * v + e.value.m11 * a};
}

}  // namespace thimble
