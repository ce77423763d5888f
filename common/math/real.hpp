// A double whose elementary functions are the portable ones, for templates that find their functions by the type of the argument. So the
// distributions of Boost.Math and Boost.Random have the same bits on every machine, too.
//
// Arithmetic is that of double. It becomes a double only where the caller asks for one.
#pragma once

#include <cmath>
#include <limits>
#include <ostream>
#include <type_traits>

#include <boost/math/policies/policy.hpp>

#include "common/math/portable.hpp"

namespace thimble::portable {

class Real {
  public:
    constexpr Real() = default;
    // Implicit, as templates take whole numbers and constants for it.
    template <class Number, std::enable_if_t<std::is_arithmetic_v<Number>, int> = 0>
    constexpr Real(Number value) : value_(static_cast<double>(value)) {}

    template <class Number, std::enable_if_t<std::is_arithmetic_v<Number>, int> = 0>
    explicit constexpr operator Number() const {
        return static_cast<Number>(value_);
    }

    constexpr Real operator-() const { return -value_; }
    constexpr Real& operator+=(Real x) { return *this = *this + x; }
    constexpr Real& operator-=(Real x) { return *this = *this - x; }
    constexpr Real& operator*=(Real x) { return *this = *this * x; }
    constexpr Real& operator/=(Real x) { return *this = *this / x; }

    friend constexpr Real operator+(Real a, Real b) { return a.value_ + b.value_; }
    friend constexpr Real operator-(Real a, Real b) { return a.value_ - b.value_; }
    friend constexpr Real operator*(Real a, Real b) { return a.value_ * b.value_; }
    friend constexpr Real operator/(Real a, Real b) { return a.value_ / b.value_; }

    friend constexpr bool operator==(Real a, Real b) { return a.value_ == b.value_; }
    friend constexpr bool operator!=(Real a, Real b) { return a.value_ != b.value_; }
    friend constexpr bool operator<(Real a, Real b) { return a.value_ < b.value_; }
    friend constexpr bool operator>(Real a, Real b) { return a.value_ > b.value_; }
    friend constexpr bool operator<=(Real a, Real b) { return a.value_ <= b.value_; }
    friend constexpr bool operator>=(Real a, Real b) { return a.value_ >= b.value_; }

    // Exact by IEEE 754 or by their nature.
    friend Real abs(Real x) { return std::fabs(x.value_); }
    friend Real fabs(Real x) { return std::fabs(x.value_); }
    friend Real sqrt(Real x) { return std::sqrt(x.value_); }
    friend Real floor(Real x) { return std::floor(x.value_); }
    friend Real ceil(Real x) { return std::ceil(x.value_); }
    friend Real ldexp(Real x, int exponent) { return std::ldexp(x.value_, exponent); }
    friend Real frexp(Real x, int* exponent) { return std::frexp(x.value_, exponent); }

    friend Real exp(Real x) { return portable::exp(x.value_); }
    friend Real log(Real x) { return portable::log(x.value_); }
    friend Real sin(Real x) { return portable::sin(x.value_); }
    friend Real cos(Real x) { return portable::cos(x.value_); }
    friend Real acos(Real x) { return portable::acos(x.value_); }
    friend Real asin(Real x) { return portable::atan2(x.value_, std::sqrt((1 - x.value_) * (1 + x.value_))); }
    friend Real pow(Real x, Real y) { return portable::pow(x.value_, y.value_); }

    friend std::ostream& operator<<(std::ostream& out, Real x) { return out << x.value_; }

  private:
    double value_ = 0;
};

// No long double: it has other bits on other machines.
using InReal = boost::math::policies::policy<boost::math::policies::promote_float<false>,
                                             boost::math::policies::promote_double<false>>;

}  // namespace thimble::portable

template <>
class std::numeric_limits<thimble::portable::Real> : public std::numeric_limits<double> {
    using Double = std::numeric_limits<double>;

  public:
    static constexpr thimble::portable::Real min() { return Double::min(); }
    static constexpr thimble::portable::Real max() { return Double::max(); }
    static constexpr thimble::portable::Real lowest() { return Double::lowest(); }
    static constexpr thimble::portable::Real epsilon() { return Double::epsilon(); }
    static constexpr thimble::portable::Real round_error() { return Double::round_error(); }
    static constexpr thimble::portable::Real infinity() { return Double::infinity(); }
    static constexpr thimble::portable::Real quiet_NaN() { return Double::quiet_NaN(); }          // NOLINT
    static constexpr thimble::portable::Real signaling_NaN() { return Double::signaling_NaN(); }  // NOLINT
    static constexpr thimble::portable::Real denorm_min() { return Double::denorm_min(); }
};
