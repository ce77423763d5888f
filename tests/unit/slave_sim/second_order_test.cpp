// The propagator against the textbook formulas at 100 digits, where their cancellations do no harm.
#include "slave_sim/second_order.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <gtest/gtest.h>

namespace thimble {
namespace {

using Exact = boost::multiprecision::cpp_bin_float_100;

struct ExactPropagator {
    Exact c;
    Exact S;
    Exact P;
    Exact Q;
};

ExactPropagator exact(double m, double b, double k, double h) {
    const Exact t = h;
    const Exact a = Exact(b) / m;
    const Exact w2 = Exact(k) / m;
    Exact S;
    Exact Q;
    if (k <
        1e-60) {  // too soft to differ in a double, and too soft for the hundred digits of the formulas below
        S = b == 0 ? t : Exact((1 - exp(-a * t)) / a);
        Q = b == 0 ? Exact(t * t / 2) : Exact((t - S) / a);
    } else {
        const Exact s = a / 2;
        const Exact square = s * s - w2;
        const Exact w = sqrt(abs(square));
        const Exact faded = exp(-s * t);
        Exact even = faded;     // cosh or cos, faded
        Exact odd = faded * t;  // sinh or sin over the frequency, faded
        if (square > 0) {
            const Exact slow = exp(-w2 / (s + w) * t);
            const Exact fast = exp(-(s + w) * t);
            even = (slow + fast) / 2;
            odd = (slow - fast) / (2 * w);
        } else if (square < 0) {
            even = faded * cos(w * t);
            odd = faded * sin(w * t) / w;
        }
        S = odd;
        Q = (1 - (even + s * odd)) / w2;
    }
    return {1 - w2 * Q, S, S + a * Q, Q};
}

double error(double value, const Exact& truth) { return std::abs(static_cast<double>(Exact(value) - truth)); }

// Each coefficient within `digits` of its natural size: S <= min(t, 1/a, 1/w), Q <= min(t^2, t/a, 1/w2), c
// <= 1.
void expect_exact(double m, double b, double k, double h) {
    SCOPED_TRACE(testing::Message() << "m " << m << " b " << b << " k " << k << " h " << h);
    const Propagator p = SecondOrder(m, b, k).propagator(h);
    const ExactPropagator truth = exact(m, b, k, h);
    const double a = b / m;
    const double w = std::sqrt(k / m);
    // Rounding of the frequency turns the phase by eps w t, however it is computed.
    const double digits = 1e-14 * (1 + (a < 2 * w ? w * h : 0));
    const double scale_s = 1 / (1 / h + a + w);
    const double scale_q = 1 / (1 / (h * h) + a / h + w * w);
    EXPECT_LE(error(p.velocity_per_velocity, truth.c), digits);
    EXPECT_LE(error(p.velocity_per_acceleration_s, truth.S), digits * scale_s);
    EXPECT_LE(error(p.position_per_acceleration_s2, truth.Q), digits * scale_q);
    EXPECT_LE(error(p.position_per_velocity_s, truth.P), digits * (scale_s + a * scale_q));
}

double drawn_decade(std::mt19937_64& bits, double low, double high) {
    const double unit = static_cast<double>(bits() >> 11) * 0x1p-53;
    return std::pow(10.0, low + (high - low) * unit);
}

TEST(SecondOrder, MatchesHighPrecisionOverTwentyDecades) {
    std::mt19937_64 bits(1);
    int compared = 0;
    for (int i = 0; i < 3000; ++i) {
        const double m = drawn_decade(bits, -9, 6);
        const double b = i % 5 == 0 ? 0 : drawn_decade(bits, -3, 3);
        const double k = i % 7 == 0 ? 0 : drawn_decade(bits, -9, 6);
        const double h = drawn_decade(bits, -7, 0.5);
        // Beyond a million radians the phase itself has no meaning left in a double.
        if (std::sqrt(k / m) * h >= 1e6) continue;
        expect_exact(m, b, k, h);
        ++compared;
    }
    EXPECT_GT(compared, 2000);
}

TEST(SecondOrder, AHairToEitherSideOfCriticalDamping) {
    for (const double m : {1e-6, 1.0, 300.0}) {
        for (const double k : {1e-3, 2.0, 1e6}) {
            for (const double hair : {-1e-3, -1e-8, -1e-12, -1e-15, 0.0, 1e-15, 1e-12, 1e-8, 1e-3}) {
                const double b = 2 * std::sqrt(k * m) * (1 + hair);
                for (const double turns : {1e-6, 1e-2, 0.5, 0.7, 0.72, 1.0, 3.0, 30.0}) {
                    expect_exact(m, b, k, turns * std::sqrt(m / k));
                }
            }
        }
    }
}

TEST(SecondOrder, VanishingSpringAndOverwhelmingDamping) {
    for (const double k : {0.0, 1e-300, 1e-30, 1e-12, 1e-6}) {
        for (const double h : {1e-9, 1e-3, 0.3, 1.0, 100.0}) {
            expect_exact(1, 1, k, h);
            expect_exact(1, 0, k, h);
            expect_exact(1e-6, 6, k, h);  // B h / M up to 6e8
        }
    }
    expect_exact(1e-9, 1e3, 2, 1e-3);
    expect_exact(1e-9, 5, 2, 1.0);
}

// Continuous where one formula hands over to the next.
TEST(SecondOrder, BordersOfTheFormulasMatch) {
    for (const double h : {1.4999999, 1.5, 1.5000001}) expect_exact(1, 1, 0.01, h);
    for (const double h : {0.70710678, 0.70710679}) expect_exact(1, 0.1, 1, h);
    for (const double h : {0.99, 1.0, 1.01}) expect_exact(1, 2.5, 1, h);
}

TEST(SecondOrder, NoTimeIsTheIdentityBitForBit) {
    for (const double b : {0.0, 1.0, 2.0, 5.0, 1e9}) {
        const Propagator p = SecondOrder(1, b, 1).propagator(0);
        EXPECT_EQ(std::bit_cast<std::uint64_t>(p.velocity_per_velocity), std::bit_cast<std::uint64_t>(1.0));
        for (const double zero :
             {p.velocity_per_acceleration_s, p.position_per_velocity_s, p.position_per_acceleration_s2}) {
            EXPECT_EQ(std::bit_cast<std::uint64_t>(zero), 0u);
        }
    }
}

TEST(SecondOrder, LongTimesReachEquilibriumOrTerminalVelocity) {
    const SecondOrder spring(2, 5, 40);
    const double a0 = spring.acceleration(3, 0.7, -0.4);
    const Propagator p = spring.propagator(1e4);
    EXPECT_NEAR(0.7 + p.position_per_velocity_s * -0.4 + p.position_per_acceleration_s2 * a0, 3.0 / 40,
                1e-15);
    EXPECT_NEAR(p.velocity_per_velocity * -0.4 + p.velocity_per_acceleration_s * a0, 0, 1e-15);

    const SecondOrder drift(2, 5, 0);
    const Propagator q = drift.propagator(1e4);
    EXPECT_NEAR(q.velocity_per_acceleration_s * drift.acceleration(3, 0, 0), 3.0 / 5, 1e-15);
}

#ifndef NDEBUG
TEST(SecondOrderDeathTest, RefusesTimesThatAreNone) {
    const SecondOrder law(1, 1, 1);
    EXPECT_DEATH(law.propagator(-1e-9), "duration");
    EXPECT_DEATH(law.propagator(std::nan("")), "duration");
}
#endif

// Where x'' changes sign, and nowhere before.
TEST(SecondOrder, InflectionsAreTheFirstZeros) {
    for (const double b : {0.0, 0.3, 2.0 - 1e-12, 2.0, 2.0 + 1e-12, 5.0, 300.0}) {
        const SecondOrder law(1, b, 1);
        for (const double v : {-1.0, -0.1, 0.0, 0.2, 3.0}) {
            for (const double a : {-2.0, -0.01, 0.4, 7.0}) {
                const double first_s = law.inflections(v, a).first_s;
                ASSERT_GT(first_s, 0);
                const double span_s = std::isinf(first_s) ? 50 : first_s;
                for (int i = 0; i < 100; ++i) {
                    const double at = law.acceleration_after(law.propagator(span_s * i / 100), v, a);
                    ASSERT_GE(at * (a > 0 ? 1 : -1), -1e-15) << b << " " << v << " " << a << " " << i;
                }
                if (std::isinf(first_s)) continue;
                ASSERT_NEAR(law.acceleration_after(law.propagator(first_s), v, a), 0, 1e-12)
                    << b << " " << v << " " << a << " " << first_s;
            }
        }
    }
}

}  // namespace
}  // namespace thimble
