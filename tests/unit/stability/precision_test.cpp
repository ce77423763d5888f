// Ten decades of every parameter: Newton on the characteristic equations themselves, at 120 digits, must not move the results.
#include <cmath>
#include <vector>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <gtest/gtest.h>

#include "stability/circle_count.hpp"
#include "stability/delayed_loop.hpp"

namespace thimble {
namespace {

using Exact =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<120>, boost::multiprecision::et_off>;
using ExactComplex = ComplexOf<Exact>;

constexpr double kLimit = 1e-12;

// Low-discrepancy exponents within five decades on each side of one.
std::vector<DelayedLoop> loops_of_ten_decades() {
    std::vector<DelayedLoop> loops;
    loops.reserve(40);
    for (int i = 1; i <= 40; ++i) {
        const auto decade = [&](double prime) {
            return std::pow(10, 10 * std::fmod(i * std::sqrt(prime), 1) - 5);
        };
        loops.push_back({{decade(2), decade(3), decade(5)}, decade(7), 0});
    }
    return loops;
}

// By how much Newton on Delta(s) = 0 moves s.
ExactComplex moved(const DelayedLoop& loop, double delay_s, const ExactComplex& s) {
    const Exact m(loop.hand.mass_kg), b(loop.hand.damping_Ns_per_m), k(loop.hand.stiffness_N_per_m);
    const Exact size = loop.stiffness_N_per_m * exp(Exact(-s.re * delay_s)), angle = s.im * delay_s;
    const ExactComplex late{size * cos(angle), -size * sin(angle)};
    const ExactComplex value = s * (s * m + ExactComplex{b, 0}) + ExactComplex{k, 0} + late;
    const ExactComplex slope = s * (2 * m) + ExactComplex{b, 0} - late * Exact(delay_s);
    return value / slope;
}

TEST(TenDecades, CriticalPoints) {
    int finite = 0;
    for (const DelayedLoop& loop : loops_of_ten_decades()) {
        const CriticalPoint point = critical_point(loop);
        if (!std::isfinite(point.delay_s)) continue;
        ++finite;
        // From the doubles: w of |P| = K, then T of that w.
        const Exact m(loop.hand.mass_kg), b(loop.hand.damping_Ns_per_m), k(loop.hand.stiffness_N_per_m);
        Exact w(point.frequency_rad_per_s);
        for (int i = 0; i < 6; ++i) {
            const Exact y = k - m * w * w, K(loop.stiffness_N_per_m);
            w -= (y * y + b * b * w * w - K * K) / (-4 * m * w * y + 2 * b * b * w);
        }
        const Exact delay = atan2(Exact(b * w), Exact(m * w * w - k)) / w;
        EXPECT_LT(abs(Exact(w / point.frequency_rad_per_s - 1)), kLimit);
        EXPECT_LT(abs(Exact(delay / point.delay_s - 1)), kLimit) << static_cast<double>(delay);
    }
    EXPECT_GT(finite, 10);
}

TEST(TenDecades, RightmostRoots) {
    int i = 0;
    for (const DelayedLoop& loop : loops_of_ten_decades()) {
        const double delay_s = std::pow(10, 6 * std::fmod(++i * std::sqrt(11), 1) - 4);
        const double fastest =
            std::sqrt((loop.hand.stiffness_N_per_m + loop.stiffness_N_per_m) / loop.hand.mass_kg);
        if (fastest * delay_s > 1e6) continue;
        const DominantRoot root = rightmost_root(loop, delay_s);
        const ExactComplex s{Exact(root.real_per_s), Exact(root.imaginary_rad_per_s)};
        const ExactComplex step = moved(loop, delay_s, s);
        EXPECT_LT(step.square(), kLimit * kLimit * s.square())
            << root.real_per_s << ' ' << root.imaginary_rad_per_s;
        // The growth rate for itself, however much faster the loop swings.
        EXPECT_LT(abs(step.re), kLimit * abs(s.re)) << root.real_per_s << ' ' << root.imaginary_rad_per_s;
    }
}

}  // namespace
}  // namespace thimble
