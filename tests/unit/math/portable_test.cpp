// The portable functions against MPFR, which rounds correctly: random arguments, the hardest ones that are known, and the edges.
#include "common/math/portable.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <mpfr.h>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common/random.hpp"

namespace thimble {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// The nightly proofs ask for 10 million.
std::size_t arguments_per_function() {
    const char* asked = std::getenv("THIMBLE_MATH_ARGUMENTS");
    return asked == nullptr ? 4000 : std::stoul(asked);
}

// A number of double's precision and range, subnormals too.
class Reference {
  public:
    Reference() {
        mpfr_set_emin(-1073);
        mpfr_set_emax(1024);
        mpfr_inits2(53, result_, first_, second_, nullptr);
    }
    Reference(const Reference&) = delete;
    Reference& operator=(const Reference&) = delete;
    ~Reference() { mpfr_clears(result_, first_, second_, nullptr); }

    template <class Function>
    double operator()(Function function, double x) {
        mpfr_set_d(first_, x, MPFR_RNDN);
        return taken(function(result_, first_, MPFR_RNDN));
    }
    template <class Function>
    double operator()(Function function, double a, double b) {
        mpfr_set_d(first_, a, MPFR_RNDN);
        mpfr_set_d(second_, b, MPFR_RNDN);
        return taken(function(result_, first_, second_, MPFR_RNDN));
    }

  private:
    double taken(int ternary) {
        mpfr_subnormalize(result_, ternary, MPFR_RNDN);
        return mpfr_get_d(result_, MPFR_RNDN);
    }
    mpfr_t result_, first_, second_;
};

struct Function {
    const char* name;
    double (*ours)(double);
    int (*theirs)(mpfr_t, const mpfr_t, mpfr_rnd_t);
    double low, high;           // evenly spread arguments lie in between
    double smallest, greatest;  // sizes of arguments of both signs, evenly spread in their logarithm
    std::vector<double> hard;
};

int mpfr_log1p_(mpfr_t result, const mpfr_t x, mpfr_rnd_t mode) { return mpfr_log1p(result, x, mode); }

// The hardest arguments of CORE-MATH's lists (core-math.gitlabpages.inria.fr): results within 2^-54 of the middle between two
// doubles, in units of their last place.
const std::vector<double> kHardForExp{0x1.0122ef37212ebp-1, 0x1.fb8586ea2d8fcp-1, 0x1.516cf0ad645ep+0,
                                      0x1.3d963bb752ap-1};
const std::vector<double> kHardForExpm1{0x1.274bbf1efb1a2p-10, 0x1.51fce10251a48p-16, -0x1.6e9b2675a667ep-44};
const std::vector<double> kHardForLog{0x1.fd15daa6ce332p+732, 0x1.9476e304cd7c7p-384, 0x1.613955dc802f8p-35};
const std::vector<double> kHardForLog10{0x1.e12d66744ff81p+429, 0x1.ed8c87c3bf5cfp-49, 1e22, 1000};
const std::vector<double> kHardForTanh{0x1.e0000000000e1p-22, 0x1.68000000017bbp-19, 0x1.1375c272d441cp+1};
const std::vector<double> kHardForCbrt{0x1.a202bfc89ddffp-1, 0x1.9b78223aa307cp+1, 27, -0.125};
const std::vector<double> kHardForSin{0x1.598bae9e632f6p-7, 0x1.1fa4f6c3eb138p+10, 0x1.021b4c18f7825p+1023,
                                      0x1.921fb54442d18p+1};
const std::vector<double> kHardForCos{0x1.34ec2f9fc9cp+1, 0x1.6b8a6273d7c21p+0, 0x1.16e534ee3658p-4,
                                      0x1.921fb54442d18p+0};
const std::vector<double> kHardForAcos{0x1.53ea6c7255e88p-4, 0x1.cf37d41c69889p-24, -1, 1};
const std::vector<double> kHardForAtan{0x1.6298b5896ed3cp+1, 0x1.22e8d75e2bc7fp-11, 0x1.ccda26ad0cd1cp+47};

const std::array<Function, 11> kFunctions{{
    {"exp", portable::exp, mpfr_exp, -745, 710, 1e-17, 700, kHardForExp},
    {"expm1", portable::expm1, mpfr_expm1, -1, 1, 1e-18, 700, kHardForExpm1},
    {"log", portable::log, mpfr_log, 0.5, 2, 1e-300, 1e300, kHardForLog},
    {"log1p", portable::log1p, mpfr_log1p_, -1, 3, 1e-17, 1e17, {}},
    {"log10", portable::log10, mpfr_log10, 1e-3, 1e3, 1e-300, 1e300, kHardForLog10},
    {"tanh", portable::tanh, mpfr_tanh, -3, 3, 1e-17, 30, kHardForTanh},
    {"cbrt", portable::cbrt, mpfr_cbrt, 0, 1, 1e-300, 1e300, kHardForCbrt},
    {"sin", portable::sin, mpfr_sin, -7, 7, 1e-10, 1e300, kHardForSin},
    {"cos", portable::cos, mpfr_cos, -7, 7, 1e-10, 1e300, kHardForCos},
    {"acos", portable::acos, mpfr_acos, -1, 1, 1e-70, 1, kHardForAcos},
    {"atan", portable::atan, mpfr_atan, -5, 5, 1e-300, 1e300, kHardForAtan},
}};

std::vector<double> arguments_of(const Function& function) {
    RandomStream random({9, 0, 0, 0, Purpose::kParameter});
    std::vector<double> all = function.hard;
    const double decades = std::log10(function.greatest / function.smallest);
    for (std::size_t i = 0; i < arguments_per_function(); ++i) {
        all.push_back(random.uniform(function.low, function.high));
        const double size = function.smallest * std::pow(10, random.uniform(0, decades));
        all.push_back(random.below(2) == 0 ? size : -size);
    }
    return all;
}

std::uint64_t bits(double value) {
    std::uint64_t all = 0;
    std::memcpy(&all, &value, sizeof all);
    return std::isnan(value) ? 0x7ff8ULL << 48 : all;
}

TEST(Portable, RoundsCorrectly) {
    Reference reference;
    for (const Function& function : kFunctions) {
        std::size_t wrong = 0;
        for (const double x : arguments_of(function)) {
            const double ours = function.ours(x), theirs = reference(function.theirs, x);
            if (bits(ours) == bits(theirs)) continue;
            if (++wrong < 4)
                ADD_FAILURE() << function.name << std::hexfloat << '(' << x << ") = " << ours << ", not "
                              << theirs;
        }
        EXPECT_EQ(wrong, 0U) << function.name;
    }
}

TEST(Portable, TheAngleOfAPointRoundsCorrectly) {
    Reference reference;
    RandomStream random({9, 0, 0, 1, Purpose::kParameter});
    const auto coordinate = [&random] { return random.normal() * std::exp(100 * random.normal()); };
    const auto expect_exact = [&reference](double y, double x) {
        ASSERT_EQ(bits(portable::atan2(y, x)), bits(reference(mpfr_atan2, y, x)))
            << std::hexfloat << y << ' ' << x;
    };
    for (const double y : {1e-200, 1e-174, 1e-173}) {  // the angle vanishes, or is subnormal
        expect_exact(y, 1e150);
        expect_exact(-y, 1e150);
    }
    for (std::size_t i = 0; i < arguments_per_function(); ++i) {
        const double y = coordinate(), x = i % 2 == 0 ? coordinate() : y * random.normal();
        expect_exact(y, x);
        if (HasFatalFailure()) return;
    }
}

TEST(Portable, PowersRoundCorrectly) {
    Reference reference;
    RandomStream random({9, 0, 0, 2, Purpose::kParameter});
    const auto check = [&reference](double x, double y) {
        EXPECT_EQ(bits(portable::pow(x, y)), bits(reference(mpfr_pow, x, y)))
            << std::hexfloat << x << ' ' << y;
    };
    for (std::size_t i = 0; i < arguments_per_function(); ++i) {
        const double x = std::exp(100 * random.normal());
        check(x, random.uniform(-750, 750) / std::log(x));  // results of all sizes
        check(1 + 1e-3 * random.normal(), 1e4 * random.normal());
        check(random.uniform(0, 100), random.uniform(-3, 3));
        // Whole and half ones, many of them exact or in the middle between two doubles.
        const auto root = static_cast<double>(random.below(1U << 27));
        check(root * root, 0.5 * random.below(7));
        check(-static_cast<double>(random.below(1000)), static_cast<double>(random.below(40)) - 20);
    }
    for (int decade = -330; decade < 310; ++decade) check(10, decade);
    for (double half = -1080; half < 1025; half += 0.5) check(2, half);
    check(1.5, 34);          // in the middle between two doubles
    check(3 * 0x1p-215, 5);  // the same below the normal doubles: 121.5 x 2^-1074
    check(5 * 0x1p-215, 5);
}

TEST(Portable, EdgesAreThoseOfC) {
    const std::array edges{0.0, -0.0,     1.0,  -1.0, 0.5,     -2.0,      1e-320,
                           1e3, kEndless, kNan, -1e3, -1e-320, -kEndless, std::numbers::pi};
    Reference reference;
    for (const Function& function : kFunctions) {
        for (const double x : edges)
            EXPECT_EQ(bits(function.ours(x)), bits(reference(function.theirs, x)))
                << function.name << ' ' << x;
    }
    for (const double y : edges) {
        for (const double x : edges) {
            EXPECT_EQ(bits(portable::atan2(y, x)), bits(reference(mpfr_atan2, y, x))) << y << ' ' << x;
            EXPECT_EQ(bits(portable::pow(y, x)), bits(reference(mpfr_pow, y, x))) << y << ' ' << x;
        }
    }
}

}  // namespace
}  // namespace thimble
