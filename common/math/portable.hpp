// Elementary functions with the same bits on every machine: rounded correctly, to nearest. A result depends on
// nothing but its argument: not on the CPU, whose instructions choose the variants of a C library, nor on compiler,
// optimisation or library.
//
// Everything that reaches a file, a message or a branch uses these; plain std::exp and its like are refused outside of drawing by
// tests/checks/purity.py. Units are none, angles are in radians; nan gives nan, and a domain error too.
//
// Each function computes with some 95 bits (double_double.hpp). Where that does not tell to which side a result must be rounded, once in
// some 2^40 arguments, it asks exact.hpp. exp, expm1 and tanh first try some 58 bits, which are enough for nine of ten arguments.
// A. Ziv, "Fast evaluation of elementary mathematical functions with correctly rounded last bit", ACM Transactions on Mathematical
// Software 17(3), 1991.
#pragma once

namespace thimble::portable {

double exp(double x);
double expm1(double x);  // e^x - 1
double log(double x);    // -inf at 0
double log1p(double x);  // log(1 + x)
double log10(double x);
double tanh(double x);
double cbrt(double x);
double pow(double x, double y);  // as C's

double sin(double x);  // nan at infinity
double cos(double x);
double acos(double x);
double atan(double x);
double atan2(double y, double x);  // in [-pi, pi], as C's

}  // namespace thimble::portable
