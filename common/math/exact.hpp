// The slow and sure way of portable.hpp: the same functions with 60 decimal digits by Boost.Multiprecision, which
// computes with integers. It decides the few results that lie too close to the middle between two doubles, and makes
// the tables of the fast way.
#pragma once

#include <span>

#include "common/math/double_double.hpp"

namespace thimble::exact {

// Rounded to nearest, ties to even, also where the result is subnormal. The argument is finite and in the function's domain.
double exp(double x);
double expm1(double x);
double log(double x);
double log1p(double x);
double log10(double x);
double tanh(double x);
double cbrt(double x);
double pow(double x, double y);  // x > 0
double sin(double x);
double cos(double x);
double acos(double x);
double atan2(double y, double x);

// Tables of n values, to some 106 bits, each value from the one before: a program waits for them when it starts.
void fill_powers_of_two(std::span<DoubleDouble> table);  // 2^(i / n)
void fill_logarithms(std::span<DoubleDouble> table);     // log(2 i / n), i > 0
void fill_sines(std::span<DoubleDouble> table);          // sin(2 pi i / n), n a multiple of 4
void fill_arc_tangents(std::span<DoubleDouble> table);   // atan(i / (n - 1))

DoubleDouble natural_logarithm(double x);
DoubleDouble inverse_of_natural_logarithm(double x);

// Parts of a constant that are short enough for exact products with whole numbers, and the rest: the first two have 26 bits each.
struct Parts {
    double first = 0, second = 0;
    DoubleDouble rest;
};
Parts parts_of_logarithm_of_two(int divisor);
Parts parts_of_pi(int divisor);

}  // namespace thimble::exact
