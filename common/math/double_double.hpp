// Sums of two doubles, some 106 bits together, for results that are then rounded once. Nothing but +, -, *, / and sqrt of IEEE 754 double,
// so every machine computes the same bits; the build forbids the compiler to fuse a product and a sum.
//
// T. J. Dekker, "A floating-point technique for extending the available precision", Numerische Mathematik 18, 1971;
// D. E. Knuth, The Art of Computer Programming 2, section 4.2.2.
#pragma once

#include <cmath>
#include <cstddef>

namespace thimble {

// |low| is at most half a unit in the last place of `high`, where nothing else is said.
struct DoubleDouble {
    double high = 0, low = 0;
};

// a + b, exactly.
constexpr DoubleDouble exact_sum(double a, double b) {
    const double sum = a + b, shared = sum - a;
    return {sum, (a - (sum - shared)) + (b - shared)};
}
// The same, for |a| >= |b| or a = 0.
constexpr DoubleDouble exact_sum_of_ordered(double a, double b) {
    const double sum = a + b;
    return {sum, b - (sum - a)};
}
// a * b, exactly, for factors and products between 2^-960 and 2^990.
constexpr DoubleDouble exact_product(double a, double b) {
    constexpr double kSplitter = 134217729;  // 2^27 + 1
    const double a_scaled = kSplitter * a, b_scaled = kSplitter * b;
    const double a_high = a_scaled - (a_scaled - a), b_high = b_scaled - (b_scaled - b);
    const double a_low = a - a_high, b_low = b - b_high;
    const double product = a * b;
    return {product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low};
}

// The operations below have relative errors under 2^-101; that of a sum is relative to the larger operand.
constexpr DoubleDouble operator-(DoubleDouble a) { return {-a.high, -a.low}; }
constexpr DoubleDouble operator+(DoubleDouble a, DoubleDouble b) {
    const DoubleDouble high = exact_sum(a.high, b.high), low = exact_sum(a.low, b.low);
    const DoubleDouble middle = exact_sum_of_ordered(high.high, high.low + low.high);
    return exact_sum_of_ordered(middle.high, middle.low + low.low);
}
constexpr DoubleDouble operator+(DoubleDouble a, double b) {
    const DoubleDouble sum = exact_sum(a.high, b);
    return exact_sum_of_ordered(sum.high, sum.low + a.low);
}
constexpr DoubleDouble operator+(double a, DoubleDouble b) { return b + a; }
constexpr DoubleDouble operator-(DoubleDouble a, DoubleDouble b) { return a + -b; }
constexpr DoubleDouble operator*(DoubleDouble a, DoubleDouble b) {
    const DoubleDouble product = exact_product(a.high, b.high);
    return exact_sum_of_ordered(product.high, product.low + (a.high * b.low + a.low * b.high));
}
constexpr DoubleDouble operator*(DoubleDouble a, double b) {
    const DoubleDouble product = exact_product(a.high, b);
    return exact_sum_of_ordered(product.high, product.low + a.low * b);
}
constexpr DoubleDouble operator*(double a, DoubleDouble b) { return b * a; }
constexpr DoubleDouble operator/(DoubleDouble a, DoubleDouble b) {
    const double first = a.high / b.high;
    const DoubleDouble rest = a - b * first;
    const double second = rest.high / b.high;
    const DoubleDouble more = rest - b * second;
    return exact_sum_of_ordered(first, second) + more.high / b.high;
}
inline DoubleDouble square_root(DoubleDouble a) {
    if (a.high == 0) return a;
    const double root = std::sqrt(a.high);
    const DoubleDouble rest = a - exact_product(root, root);
    return exact_sum_of_ordered(root, rest.high / (2 * root));
}

// By a power of two, exactly where nothing becomes subnormal.
inline DoubleDouble scaled(DoubleDouble a, int exponent) {
    return {std::ldexp(a.high, exponent), std::ldexp(a.low, exponent)};
}

// a[0] + x (a[1] + x (a[2] + ...)), all in double.
template <std::size_t N>
constexpr double polynomial(const double (&a)[N], double x) {
    double sum = a[N - 1];
    for (std::size_t i = N - 1; i-- > 0;) sum = sum * x + a[i];
    return sum;
}

// Ziv's test, which ends the fast way of portable.hpp: is it sure to which double a result is to be rounded?
// `exactly()` decides where `result` with its relative error leaves it open; also below the normal doubles, which have fewer bits.
template <class Exactly>
double rounded(DoubleDouble result, Exactly exactly, double relative_error = 0x1p-85) {
    constexpr double kLeastNormal = 0x1p-1000;
    const double error = std::abs(result.high) * relative_error;
    const double upper = result.high + (result.low + error), lower = result.high + (result.low - error);
    return upper == lower && std::abs(upper) > kLeastNormal ? upper : exactly();
}

}  // namespace thimble
