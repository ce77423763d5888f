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
    return std::copysign(std::ldexp(whole + (up ? 1 : 0), -1074), value < 0 ? -1.0 : 1.0);  // of -0, too
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

// x + sign x^3 / 3 + x^5 / 5 + sign x^7 / 7 + ...: artanh or, with sign -1, arctan.
Precise odd_series(const Precise& x, int sign) {
    const Precise square = sign * x * x, negligible = mp::ldexp(x, -210);
    Precise sum = x, power = x;
    for (int k = 3; mp::abs(power) > negligible; k += 2) {
        power *= square;
        sum += power / k;
    }
    return sum;
}

// The angle without whole turns; its sine and cosine are the same.
Precise within_one_turn(double x) {
    const Angle turn = 2 * boost::math::constants::pi<Angle>();
    return Precise(mp::fmod(Angle(x), turn));
}

// Extra digits for the cancellation in e^x - 1 and log(1 + x): a hard case needs 36 digits, and up to 17 cancel for x
// above 2^-54.
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

void fill_powers_of_two(std::span<DoubleDouble> table) {
    const Precise step = mp::exp(Precise(logarithm_of_two() / table.size()));
    Precise power = 1;
    for (DoubleDouble& value : table) {
        value = split(power);
        power *= step;
    }
}

// log(i + 1) = log(i) + 2 artanh(1 / (2 i + 1))
void fill_logarithms(std::span<DoubleDouble> table) {
    Precise logarithm = -mp::log(Precise(table.size()) / 2);
    for (std::size_t i = 1; i < table.size(); ++i) {
        table[i] = 2 * i == table.size() ? DoubleDouble{} : split(logarithm);
        logarithm += 2 * odd_series(Precise(1) / (2 * i + 1), 1);
    }
}

// A quarter of a turn by rotation, the others by symmetry: whole half turns are exactly 0.
void fill_sines(std::span<DoubleDouble> table) {
    const std::size_t half = table.size() / 2, quarter = half / 2;
    const Precise angle = pi() / half, step_sine = mp::sin(angle), step_cosine = mp::cos(angle);
    Precise sine = 0, cosine = 1;
    for (std::size_t i = 0; i <= quarter; ++i) {
        table[i] = table[half - i] = i == quarter ? DoubleDouble{1} : split(sine);
        const Precise turned = sine * step_cosine + cosine * step_sine;
        cosine = cosine * step_cosine - sine * step_sine;
        sine = turned;
    }
    for (std::size_t i = 0; i < half; ++i) table[half + i] = -table[i];
}

// atan((i + 1) / n) = atan(i / n) + atan(n / (n^2 + i (i + 1)))
void fill_arc_tangents(std::span<DoubleDouble> table) {
    const std::size_t n = table.size() - 1;
    Precise angle = 0;
    for (std::size_t i = 0; i <= n; ++i) {
        table[i] = split(angle);
        angle += odd_series(Precise(n) / (n * n + i * (i + 1)), -1);
    }
}

DoubleDouble natural_logarithm(double x) { return split(Precise(mp::log(Precise(x)))); }
DoubleDouble inverse_of_natural_logarithm(double x) { return split(Precise(1 / mp::log(Precise(x)))); }

Parts parts_of_logarithm_of_two(int divisor) { return parts_of(logarithm_of_two() / divisor); }
Parts parts_of_pi(int divisor) { return parts_of(pi() / divisor); }

}  // namespace thimble::exact
