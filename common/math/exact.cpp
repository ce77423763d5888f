#include "common/math/exact.hpp"

#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>

namespace thimble::exact {
namespace {

namespace mp = boost::multiprecision;

template <unsigned kDigits>
using Number = mp::number<mp::cpp_bin_float<kDigits>, mp::et_off>;
using Precise = Number<60>;
// An angle of any size loses none of its digits when whole turns are taken off.
using Angle = Number<400>;

// Their conversion rounds a subnormal result twice.
double nearest(const Precise& value) {
    constexpr int kLeastExponent = -1021;
    int exponent = 0;
    mp::frexp(value, &exponent);
    if (value == 0 || exponent >= kLeastExponent) return value.convert_to<double>();
    const Precise steps = mp::ldexp(value, 1074), below = mp::floor(steps), rest = steps - below;
    const auto whole = below.convert_to<double>();
    const bool up = rest == 0.5 ? std::fmod(whole, 2) != 0 : rest > 0.5;
    return std::ldexp(whole + (up ? 1 : 0), -1074);
}

template <class Value>
DoubleDouble split(const Value& value) {
    const auto high = value.template convert_to<double>();
    return {high, Value(value - high).template convert_to<double>()};
}

double short_part(const Precise& value) {
    constexpr int kBits = 26;
    int exponent = 0;
    const Precise fraction = mp::frexp(value, &exponent);
    const Precise whole = mp::trunc(mp::ldexp(fraction, kBits));
    return mp::ldexp(whole, exponent - kBits).template convert_to<double>();
}

Parts parts_of(const Precise& value) {
    const double first = short_part(value), second = short_part(value - first);
    return {first, second, split(Precise(value - first - second))};
}

Precise pi() { return boost::math::constants::pi<Precise>(); }
Precise logarithm_of_two() { return mp::log(Precise(2)); }

// The angle without whole turns; its sine and cosine are the same.
Precise within_one_turn(double x) {
    const Angle turn = 2 * boost::math::constants::pi<Angle>();
    return Precise(mp::fmod(Angle(x), turn));
}

// Digits that cancel in e^x - 1 and log(1 + x) are there to lose: 60 against the 36 of a hard case and at most 17 for x above 2^-54.
using Wide = Number<90>;

// A power can lie exactly in the middle between two doubles, with 54 bits. Its logarithm only comes close to that, within some 2^-230;
// among all other powers none lies closer than some 2^-170.
Wide settled(const Wide& value) {
    constexpr int kBits = 54;
    const Wide kClose = mp::ldexp(Wide(1), -140);
    int exponent = 0;
    const Wide steps = mp::ldexp(mp::frexp(value, &exponent), kBits), whole = mp::round(steps);
    return mp::abs(steps - whole) < kClose ? mp::ldexp(whole, exponent - kBits) : value;
}

}  // namespace

double exp(double x) { return nearest(mp::exp(Precise(x))); }
double expm1(double x) { return nearest(Precise(mp::exp(Wide(x)) - 1)); }
double log(double x) { return nearest(mp::log(Precise(x))); }
double log1p(double x) { return nearest(Precise(mp::log(1 + Wide(x)))); }
double log10(double x) { return nearest(mp::log10(Precise(x))); }
double tanh(double x) {
    const Wide grown = mp::exp(2 * Wide(x)) - 1;
    return nearest(Precise(grown / (grown + 2)));
}
double cbrt(double x) { return nearest(mp::cbrt(Precise(x))); }
double pow(double x, double y) { return nearest(Precise(settled(mp::exp(y * mp::log(Wide(x)))))); }
double sin(double x) { return nearest(mp::sin(within_one_turn(x))); }
double cos(double x) { return nearest(mp::cos(within_one_turn(x))); }
double acos(double x) { return nearest(mp::acos(Precise(x))); }
double atan2(double y, double x) { return nearest(mp::atan2(Precise(y), Precise(x))); }

DoubleDouble power_of_two(double exponent) { return split(Precise(mp::exp(exponent * logarithm_of_two()))); }
DoubleDouble natural_logarithm(double x) { return split(Precise(mp::log(Precise(x)))); }
DoubleDouble inverse_of_natural_logarithm(double x) { return split(Precise(1 / mp::log(Precise(x)))); }
DoubleDouble sine_of_pi_times(double share) {
    // Whole half turns give 0, although pi is rounded.
    return share == std::floor(share) ? DoubleDouble{} : split(Precise(mp::sin(pi() * share)));
}
DoubleDouble arc_tangent(double x) { return split(Precise(mp::atan(Precise(x)))); }

Parts parts_of_logarithm_of_two(int divisor) { return parts_of(logarithm_of_two() / divisor); }
Parts parts_of_pi(int divisor) { return parts_of(pi() / divisor); }

}  // namespace thimble::exact
