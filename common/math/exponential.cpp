// Exponentials and logarithms: argument reduction by tables, then short series.
#include <array>
#include <cmath>
#include <limits>

#include "common/math/exact.hpp"
#include "common/math/portable.hpp"

namespace thimble::portable {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
// Below it e^x - 1, log(1 + x) and tanh x are x to the last bit.
constexpr double kTiny = 0x1p-54;

constexpr int kSteps = 64;  // of a factor of two, and of the interval of a mantissa

struct ExponentialTable {
    exact::Parts step = exact::parts_of_logarithm_of_two(kSteps);
    std::array<DoubleDouble, kSteps> powers{};  // 2^(i / 64)
    ExponentialTable() { exact::fill_powers_of_two(powers); }
};
const ExponentialTable& exponential_table() {
    static const ExponentialTable table;
    return table;
}

struct LogarithmTable {
    DoubleDouble of_two = exact::natural_logarithm(2), per_ten = exact::inverse_of_natural_logarithm(10);
    std::array<DoubleDouble, 2UL * kSteps> logarithms{};  // log(i / 64)
    LogarithmTable() { exact::fill_logarithms(logarithms); }
};
const LogarithmTable& logarithm_table() {
    static const LogarithmTable table;
    return table;
}

// Both are made when a program starts: no tick of a node waits for them.
[[maybe_unused]] const bool kMade = (exponential_table(), logarithm_table(), true);

// e^r - 1 for |r| < 0.006, relative error below 2^-98.
DoubleDouble short_expm1(DoubleDouble r) {
    constexpr double kTail[] = {1.0 / 720,    1.0 / 5040,    1.0 / 40320,
                                1.0 / 362880, 1.0 / 3628800, 1.0 / 39916800};
    constexpr DoubleDouble kThird = DoubleDouble{1} / DoubleDouble{3},
                           kFifth = DoubleDouble{1} / DoubleDouble{5};
    // 1 + r/2 (1 + r/3 (1 + r/4 (1 + r/5 (1 + 120 r tail))))
    DoubleDouble sum = exact_sum_of_ordered(1, 120 * r.high * polynomial(kTail, r.high));
    sum = 1 + r * kFifth * sum;
    sum = 1 + r * 0.25 * sum;
    sum = 1 + r * kThird * sum;
    sum = 1 + r * 0.5 * sum;
    return r * sum;
}

// x = steps log(2) / 64 + rest
struct Reduced {
    int steps = 0;
    DoubleDouble rest{};
};
Reduced reduce(DoubleDouble x) {
    constexpr double kStepsPerUnit = 92.332482616893656877;  // 64 / log(2)
    const auto& part = exponential_table().step;
    const double steps = std::nearbyint(x.high * kStepsPerUnit);
    const DoubleDouble rest =
        (exact_sum(x.high - steps * part.first, -steps * part.second) + x.low) + part.rest * -steps;
    return {static_cast<int>(steps), rest};
}

// 2^(steps / 64) without its whole powers of two.
DoubleDouble power_of(int steps) {
    return exponential_table().powers[static_cast<std::size_t>(steps & (kSteps - 1))];
}

// e^x and e^x - 1, for results that neither overflow nor vanish.
DoubleDouble wide_exp(DoubleDouble x) {
    const Reduced reduced = reduce(x);
    const DoubleDouble power = power_of(reduced.steps);
    return scaled(power + power * short_expm1(reduced.rest), reduced.steps >> 6);
}

// e^x in a fifth of the operations. Four roundings, each of at most 2^-53 of a growth below 0.0055, leave this relative error.
constexpr double kQuickError = 0x1p-58;
DoubleDouble quick_exp(double x) {
    constexpr double kTail[] = {1.0 / 2, 1.0 / 6, 1.0 / 24, 1.0 / 120, 1.0 / 720};
    const Reduced reduced = reduce({x, 0});
    const DoubleDouble power = power_of(reduced.steps);
    const double r = reduced.rest.high;
    const double growth = r + (r * r * polynomial(kTail, r) + reduced.rest.low);
    return scaled(exact_sum_of_ordered(power.high, power.low + power.high * growth), reduced.steps >> 6);
}

// a / b with a relative error below 2^-100, in a fifth of the operations.
DoubleDouble quick_quotient(DoubleDouble a, DoubleDouble b) {
    const double first = a.high / b.high;
    const DoubleDouble taken = exact_product(first, b.high);
    const double rest = ((a.high - taken.high) - taken.low) + (a.low - first * b.low);
    return exact_sum_of_ordered(first, rest / b.high);
}

// Where this is true, the errors of e^x - 1 and of tanh(x / 2) are less than twice that of e^x.
bool quick_enough(double x) { return std::abs(x) > 0.7; }

DoubleDouble wide_expm1(DoubleDouble x) {
    return std::abs(x.high) < 0.005 ? short_expm1(x) : wide_exp(x) + -1.0;
}

// log(high + low), relative error below 2^-94.
DoubleDouble wide_log(double high, double low) {
    int exponent = 0;
    double mantissa = std::frexp(high, &exponent);
    if (mantissa < 0.70710678118654752) {
        mantissa *= 2;
        --exponent;
    }
    const double below = std::ldexp(low, -exponent);
    const double place = std::nearbyint(mantissa * kSteps), center = place / kSteps;
    // log(m / c) = 2 atanh(s),  s = (m - c) / (m + c)
    const DoubleDouble s = exact_sum(mantissa - center, below) / (exact_sum(mantissa, center) + below);
    constexpr double kTail[] = {1.0 / 9, 1.0 / 11, 1.0 / 13, 1.0 / 15};
    constexpr DoubleDouble kThird = DoubleDouble{1} / DoubleDouble{3},
                           kFifth = DoubleDouble{1} / DoubleDouble{5},
                           kSeventh = DoubleDouble{1} / DoubleDouble{7};
    const DoubleDouble square = s * s;
    DoubleDouble sum = kSeventh + square.high * polynomial(kTail, square.high);
    sum = kFifth + square * sum;
    sum = kThird + square * sum;
    sum = 1 + square * sum;
    const auto& table = logarithm_table();
    return (table.of_two * exponent + table.logarithms[static_cast<std::size_t>(place)]) + 2 * (s * sum);
}

// x^y of positive x. The ten bits before the point of y log(x) are lost to the result.
double power_of_size(double x, double y) {
    constexpr double kRelativeError = 0x1p-82, kOverflow = 710, kVanishes = -746, kSafe = 700;
    const DoubleDouble logarithm = wide_log(x, 0);
    const double exponent = y * logarithm.high;
    if (x == 1 || std::abs(exponent) < kTiny / 2) return 1;
    if (exponent > kOverflow) return kInfinity;
    if (exponent < kVanishes) return 0;
    if (std::abs(exponent) > kSafe) return exact::pow(x, y);
    return rounded(
        wide_exp(logarithm * y), [=] { return exact::pow(x, y); }, kRelativeError);
}

}  // namespace

double exp(double x) {
    constexpr double kOverflow = 709.782712893384, kVanishes = -745.1332191019412;
    if (std::isnan(x)) return x;
    if (x > kOverflow) return kInfinity;
    if (x < kVanishes) return 0;
    if (std::abs(x) < kTiny) return 1;
    if (std::abs(x) > 700) return exact::exp(x);  // powers of the table would overflow or vanish
    return rounded(
        quick_exp(x),
        [x] {
            return rounded(wide_exp({x, 0}), [x] { return exact::exp(x); });
        },
        kQuickError);
}

double expm1(double x) {
    if (std::isnan(x) || std::abs(x) < kTiny) return x;
    if (x > 700) return exp(x);
    if (x < -50) return -1;
    const auto surely = [x] { return rounded(wide_expm1({x, 0}), [x] { return exact::expm1(x); }); };
    return quick_enough(x) ? rounded(quick_exp(x) + -1.0, surely, 2 * kQuickError) : surely();
}

double log(double x) {
    if (std::isnan(x) || x < 0) return kNan;
    if (x == 0) return -kInfinity;
    if (std::isinf(x)) return x;
    if (x == 1) return 0;
    return rounded(wide_log(x, 0), [x] { return exact::log(x); });
}

double log1p(double x) {
    if (std::isnan(x) || x < -1) return kNan;
    if (x == -1) return -kInfinity;
    if (std::isinf(x) || std::abs(x) < kTiny) return x;
    const DoubleDouble sum = exact_sum(1, x);
    return rounded(wide_log(sum.high, sum.low), [x] { return exact::log1p(x); });
}

double log10(double x) {
    if (!(x > 0) || std::isinf(x) || x == 1) return log(x);
    return rounded(wide_log(x, 0) * logarithm_table().per_ten, [x] { return exact::log10(x); });
}

double tanh(double x) {
    if (std::isnan(x) || std::abs(x) < 0x1p-28)
        return std::abs(x) < kTiny || std::isnan(x) ? x : exact::tanh(x);
    if (std::abs(x) > 20) return std::copysign(1.0, x);
    // grown / (grown + 2), of grown = e^2x - 1
    const auto surely = [x] {
        const DoubleDouble grown = wide_expm1({2 * x, 0});
        return rounded(grown / (grown + 2.0), [x] { return exact::tanh(x); });
    };
    if (!quick_enough(2 * x)) return surely();
    const DoubleDouble grown = quick_exp(2 * x) + -1.0;
    return rounded(quick_quotient(grown, grown + 2.0), surely, 2 * kQuickError);
}

// Newton's method from the logarithm.
double cbrt(double x) {
    if (x == 0 || !std::isfinite(x)) return x;
    int exponent = 0;
    double mantissa = std::frexp(std::abs(x), &exponent);
    for (; exponent % 3 != 0; ++exponent) mantissa /= 2;
    const double guess = exp(log(mantissa) / 3);
    const DoubleDouble rest = exact_product(guess, guess) * guess + -mantissa;
    const double root = guess - rest.high / (3 * guess * guess);
    const DoubleDouble more = exact_product(root, root) * root + -mantissa;
    const double refined = rounded(exact_sum_of_ordered(root, -more.high / (3 * root * root)),
                                   [mantissa] { return exact::cbrt(mantissa); });
    return std::copysign(std::ldexp(refined, exponent / 3), x);
}

double pow(double x, double y) {
    if (x == 1 || y == 0) return 1;
    if (std::isnan(x) || std::isnan(y)) return kNan;
    const double size = std::abs(x);
    if (std::isinf(y)) return size == 1 ? 1 : ((size > 1) == (y > 0) ? kInfinity : 0);
    if (x < 0 && std::isfinite(x) && y != std::trunc(y)) return kNan;
    const double sign = std::signbit(x) && std::abs(std::fmod(y, 2)) == 1 ? -1 : 1;
    if (size == 0 || std::isinf(size)) return sign * ((size == 0) == (y < 0) ? kInfinity : 0);
    return sign * power_of_size(size, y);
}

}  // namespace thimble::portable
