// Numbers in which the theory is computed; for this room only.
//
// Ten decades of every parameter make sums in which forty digits cancel; with sixty none has to be rearranged for that. One
// evaluation costs microseconds, which nothing here is asked for often enough to notice.
#pragma once

#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>

namespace thimble {

using Precise =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<60>, boost::multiprecision::et_off>;

inline double to_double(const Precise& value) { return static_cast<double>(value); }
inline double to_double(double value) { return value; }

template <class Real>
Real pi_of() {
    return boost::math::constants::pi<Real>();
}

// Functions that std::complex need not offer for such numbers.
template <class Real>
struct ComplexOf {
    Real re, im;

    ComplexOf operator+(const ComplexOf& z) const { return {re + z.re, im + z.im}; }
    ComplexOf operator-(const ComplexOf& z) const { return {re - z.re, im - z.im}; }
    ComplexOf operator*(const ComplexOf& z) const { return {re * z.re - im * z.im, re * z.im + im * z.re}; }
    ComplexOf operator*(const Real& factor) const { return {re * factor, im * factor}; }
    ComplexOf operator/(const ComplexOf& z) const {
        const Real norm = z.re * z.re + z.im * z.im;
        return {(re * z.re + im * z.im) / norm, (im * z.re - re * z.im) / norm};
    }
    Real square() const { return re * re + im * im; }
};

}  // namespace thimble
