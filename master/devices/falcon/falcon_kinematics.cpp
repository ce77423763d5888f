#include "master/devices/falcon/falcon_kinematics.hpp"

#include <algorithm>
#include <cmath>

#include "common/math/portable.hpp"

namespace thimble {
namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

constexpr double kPi = 3.14159265358979323846;
constexpr double kRadian = kPi / 180;
// Metres (source: docs/handles.md).
constexpr double kThigh_m = 0.060, kShin_m = 0.1025, kFoot_m = 0.01443, kEnds_m = 2 * 0.01125;
constexpr double kOffset_m = -0.025, kRadius_m = 0.0400, kSide_m = -0.02309;
constexpr std::array kPlane_rad{105 * kRadian, -15 * kRadian, -135 * kRadian};
constexpr double kZeroAngle_rad = 35 * kRadian;
constexpr double kAngleOfCount_rad = 2 * kPi * 0.01425 / (4 * 320 * 0.110);  // spool, encoder lines, drum
constexpr double kLongestStep_m = 0.020;
constexpr int kMostSteps = 30;
constexpr double kGoodEnough_rad = 1e-11;

// A position as one leg sees it.
struct LegView {
    double u_m, v_m, w_m, reach_m, across_m;  // across: sqrt(b^2 - (v + f)^2)
};

std::optional<LegView> view_of(std::size_t leg, const DeviceVector& p) {
    const double cosine = portable::cos(kPlane_rad[leg]), sine = portable::sin(kPlane_rad[leg]);
    LegView view{};
    view.u_m = p[0] * cosine + p[1] * sine - kRadius_m;
    view.v_m = -p[0] * sine + p[1] * cosine - kSide_m;
    view.w_m = p[2];
    const double squared = kShin_m * kShin_m - (view.v_m + kOffset_m) * (view.v_m + kOffset_m);
    if (!(squared > 0)) return std::nullopt;
    view.across_m = std::sqrt(squared);
    view.reach_m = kEnds_m + view.across_m;
    return view;
}

std::optional<double> angle_of(const LegView& view) {
    const double a = kThigh_m, c = kFoot_m;
    const double K = view.w_m * view.w_m + view.u_m * view.u_m + 2 * c * view.u_m + a * a + c * c -
                     view.reach_m * view.reach_m;
    const double l0 = K - 2 * a * (view.u_m + c), l1 = -4 * a * view.w_m, l2 = K + 2 * a * (view.u_m + c);
    const double root = l1 * l1 - 4 * l0 * l2;
    if (!(root >= 0) || l2 == 0) return std::nullopt;
    return 2 * portable::atan((-l1 - std::sqrt(root)) / (2 * l2));
}

// d theta / d p, a row per leg. False where it has none.
bool derivative(const DeviceVector& p, const FalconAngles& angles_rad, Matrix& rows) {
    for (std::size_t leg = 0; leg < 3; ++leg) {
        const auto view = view_of(leg, p);
        if (!view) return false;
        const double cosine = portable::cos(angles_rad[leg]), sine = portable::sin(angles_rad[leg]);
        const double gu = 2 * (view->u_m + kFoot_m - kThigh_m * cosine),
                     gw = 2 * (view->w_m - kThigh_m * sine);
        const double gv = 2 * view->reach_m * (view->v_m + kOffset_m) / view->across_m;
        const double gth = 2 * kThigh_m * ((view->u_m + kFoot_m) * sine - view->w_m * cosine);
        if (std::fabs(gth) < 1e-9) return false;
        const double c = portable::cos(kPlane_rad[leg]), s = portable::sin(kPlane_rad[leg]);
        rows[leg] = {-(gu * c - gv * s) / gth, -(gu * s + gv * c) / gth, -gw / gth};
    }
    return true;
}

double determinant(const Matrix& m) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

// m x = right, by Cramer; nothing if m is singular.
std::optional<std::array<double, 3>> solve(const Matrix& m, const std::array<double, 3>& right) {
    const double whole = determinant(m);
    if (!(std::fabs(whole) > 1e-6)) return std::nullopt;
    std::array<double, 3> x{};
    for (std::size_t column = 0; column < 3; ++column) {
        Matrix replaced = m;
        for (std::size_t row = 0; row < 3; ++row) replaced[row][column] = right[row];
        x[column] = determinant(replaced) / whole;
    }
    return x;
}

double length(const DeviceVector& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

// One Newton step from p; halved until the legs reach there. False if they never do.
bool step(DeviceVector& p, DeviceVector move_m, FalconAngles& angles_rad) {
    const double long_m = length(move_m);
    double part = long_m > kLongestStep_m ? kLongestStep_m / long_m : 1;
    for (int half = 0; half < 8; ++half, part /= 2) {
        const DeviceVector next{p[0] + part * move_m[0], p[1] + part * move_m[1], p[2] + part * move_m[2]};
        const auto reached = falcon_leg_angles_rad(next);
        if (!reached) continue;
        p = next;
        angles_rad = *reached;
        return true;
    }
    return false;
}

}  // namespace

double falcon_leg_angle_rad(std::int16_t encoder_counts) {
    return kZeroAngle_rad + kAngleOfCount_rad * encoder_counts;
}

std::optional<FalconAngles> falcon_leg_angles_rad(const DeviceVector& position_m) {
    FalconAngles angles_rad{};
    for (std::size_t leg = 0; leg < 3; ++leg) {
        const auto view = view_of(leg, position_m);
        const auto angle_rad = view ? angle_of(*view) : std::nullopt;
        if (!angle_rad) return std::nullopt;
        angles_rad[leg] = *angle_rad;
    }
    return angles_rad;
}

std::optional<DeviceVector> falcon_position_m(const FalconAngles& angles_rad, const DeviceVector& near_m) {
    DeviceVector p = near_m;
    auto reached = falcon_leg_angles_rad(p);
    if (!reached) return std::nullopt;
    for (int i = 0; i < kMostSteps; ++i) {
        std::array<double, 3> missing_rad{};
        double worst_rad = 0;
        for (std::size_t leg = 0; leg < 3; ++leg) {
            missing_rad[leg] = angles_rad[leg] - (*reached)[leg];
            worst_rad = std::max(worst_rad, std::fabs(missing_rad[leg]));
        }
        if (worst_rad < kGoodEnough_rad) return p;
        Matrix rows{};
        if (!derivative(p, *reached, rows)) return std::nullopt;
        const auto move_m = solve(rows, missing_rad);
        if (!move_m || !step(p, *move_m, *reached)) return std::nullopt;
    }
    return std::nullopt;
}

// F = (d theta / d p)^T tau.
std::optional<std::array<double, 3>> falcon_leg_torques_Nm(const DeviceVector& position_m,
                                                           const DeviceVector& force_N) {
    const auto angles_rad = falcon_leg_angles_rad(position_m);
    Matrix rows{};
    if (!angles_rad || !derivative(position_m, *angles_rad, rows)) return std::nullopt;
    Matrix columns{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) columns[i][j] = rows[j][i];
    }
    return solve(columns, force_N);
}

FalconMotors falcon_motors(const std::array<double, 3>& torques_Nm, double gain_per_Nm) {
    FalconMotors motors;
    std::array<double, 3> counts{};
    double most = 0;
    for (std::size_t leg = 0; leg < 3; ++leg) {
        counts[leg] = -gain_per_Nm * torques_Nm[leg];
        if (!std::isfinite(counts[leg])) return motors;
        most = std::max(most, std::fabs(counts[leg]));
    }
    motors.saturated = most > kFalconMotorLimit;
    const double scale = motors.saturated ? kFalconMotorLimit / most : 1;
    for (std::size_t leg = 0; leg < 3; ++leg)
        motors.counts[leg] = static_cast<std::int16_t>(std::lround(scale * counts[leg]));
    return motors;
}

}  // namespace thimble
