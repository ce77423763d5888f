// Sine, cosine and their inverses: argument reduction by tables, then short series.
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "common/math/exact.hpp"
#include "common/math/portable.hpp"

namespace thimble::portable {
namespace {

constexpr int kAngleSteps = 64;  // of half a turn; of the tangent from 0 to 1

struct AngleTable {
    exact::Parts step = exact::parts_of_pi(kAngleSteps);
    DoubleDouble half_turn, quarter_turn;
    std::array<DoubleDouble, 2UL * kAngleSteps> sines{};       // sin(i pi / 64), a whole turn
    std::array<DoubleDouble, kAngleSteps + 1> arc_tangents{};  // atan(i / 64)
    AngleTable() {
        const exact::Parts pi = exact::parts_of_pi(1);
        half_turn = exact_sum(pi.first, pi.second) + pi.rest;
        quarter_turn = half_turn * 0.5;
        exact::fill_sines(sines);
        exact::fill_arc_tangents(arc_tangents);
    }
    DoubleDouble sine(int steps) const {
        return sines[static_cast<std::size_t>(steps & (2 * kAngleSteps - 1))];
    }
};
const AngleTable& angle_table() {
    static const AngleTable table;
    return table;
}

// Made when a program starts: no tick of a node waits for it.
[[maybe_unused]] const bool kAnglesMade = (angle_table(), true);

// Of |r| < 0.025, relative errors below 2^-95.
DoubleDouble short_sin(DoubleDouble r) {
    constexpr double kTail[] = {-1.0 / 5040, 1.0 / 362880, -1.0 / 39916800, 1.0 / 6227020800};
    constexpr DoubleDouble kThird = DoubleDouble{-1} / DoubleDouble{6},
                           kFifth = DoubleDouble{1} / DoubleDouble{120};
    const DoubleDouble square = r * r;
    const DoubleDouble sum = kThird + square * (kFifth + square.high * polynomial(kTail, square.high));
    return r + r * square * sum;
}
DoubleDouble short_cos(DoubleDouble r) {
    constexpr double kTail[] = {-1.0 / 720, 1.0 / 40320, -1.0 / 3628800, 1.0 / 479001600};
    constexpr DoubleDouble kFourth = DoubleDouble{1} / DoubleDouble{24};
    const DoubleDouble square = r * r;
    return 1 +
           square * (DoubleDouble{-0.5} + square * (kFourth + square.high * polynomial(kTail, square.high)));
}

// sin(x + quarters * pi / 2), for |x| < 2^20.
DoubleDouble wide_sin(double x, int quarters) {
    const AngleTable& table = angle_table();
    const double steps = std::nearbyint(x * (kAngleSteps * std::numbers::inv_pi));
    const DoubleDouble rest =
        exact_sum(x - steps * table.step.first, -steps * table.step.second) + table.step.rest * -steps;
    const int at = static_cast<int>(steps) + quarters * (kAngleSteps / 2);
    return table.sine(at) * short_cos(rest) + table.sine(at + kAngleSteps / 2) * short_sin(rest);
}

// The angle of y / x, both positive or 0 and not both 0, relative error below 2^-92.
DoubleDouble wide_angle(DoubleDouble y, DoubleDouble x) {
    const bool steep = y.high > x.high;
    if (steep) std::swap(y, x);
    const AngleTable& table = angle_table();
    const double place = std::nearbyint(y.high / x.high * kAngleSteps), center = place / kAngleSteps;
    // atan(y / x) = atan(c) + atan(t),  t = (y - c x) / (x + c y)
    const DoubleDouble t = (y - x * center) / (x + y * center);
    constexpr double kTail[] = {-1.0 / 7, 1.0 / 9, -1.0 / 11, 1.0 / 13, -1.0 / 15};
    constexpr DoubleDouble kThird = DoubleDouble{-1} / DoubleDouble{3},
                           kFifth = DoubleDouble{1} / DoubleDouble{5};
    const DoubleDouble square = t * t;
    const DoubleDouble sum = kThird + square * (kFifth + square.high * polynomial(kTail, square.high));
    const DoubleDouble angle = table.arc_tangents[static_cast<std::size_t>(place)] + (t + t * square * sum);
    return steep ? table.quarter_turn - angle : angle;
}

}  // namespace

double sin(double x) {
    if (!std::isfinite(x)) return std::numeric_limits<double>::quiet_NaN();
    if (std::abs(x) < 0x1p-27) return x;
    if (std::abs(x) > 0x1p20) return exact::sin(x);
    return rounded(wide_sin(x, 0), [x] { return exact::sin(x); });
}

double cos(double x) {
    if (!std::isfinite(x)) return std::numeric_limits<double>::quiet_NaN();
    if (std::abs(x) < 0x1p-27) return 1;
    if (std::abs(x) > 0x1p20) return exact::cos(x);
    return rounded(wide_sin(x, 1), [x] { return exact::cos(x); });
}

// The angle of (x, sqrt((1 - x) (1 + x))).
double acos(double x) {
    if (!(std::abs(x) <= 1)) return std::numeric_limits<double>::quiet_NaN();
    if (std::abs(x) < 0x1p-60 || x == 1) return x == 1 ? 0 : exact::acos(x);
    const DoubleDouble height = square_root(exact_sum(1, -x) * exact_sum(1, x));
    const DoubleDouble angle = wide_angle(height, {std::abs(x), 0});
    return rounded(x > 0 ? angle : angle_table().half_turn - angle, [x] { return exact::acos(x); });
}

double atan(double x) { return atan2(x, 1); }

double atan2(double y, double x) {
    if (std::isnan(y) || std::isnan(x)) return std::numeric_limits<double>::quiet_NaN();
    const bool back = std::signbit(x);
    if (y == 0) return std::copysign(back ? std::numbers::pi : 0.0, y);
    const double height = std::abs(y), width = std::abs(x);
    if (std::isinf(height) || std::isinf(width)) {
        const double share =
            std::isinf(height) ? (std::isinf(width) ? (back ? 0.75 : 0.25) : 0.5) : (back ? 1 : 0);
        const DoubleDouble angle = angle_table().half_turn * share;
        return std::copysign(angle.high, y);
    }
    if (x == 0) return std::copysign(std::numbers::pi / 2, y);
    // Scaled so that products neither overflow nor vanish; what is further apart than these is decided exactly.
    int height_exponent = 0, width_exponent = 0;
    const double height_part = std::frexp(height, &height_exponent),
                 width_part = std::frexp(width, &width_exponent);
    const int apart = height_exponent - width_exponent;
    if (std::abs(apart) > 200) return exact::atan2(y, x);
    const DoubleDouble angle = wide_angle({std::ldexp(height_part, apart), 0}, {width_part, 0});
    const DoubleDouble turned = back ? angle_table().half_turn - angle : angle;
    return std::copysign(rounded(turned, [&] { return std::abs(exact::atan2(y, x)); }), y);
}

}  // namespace thimble::portable
