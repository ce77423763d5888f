#include "slave_sim/crossing.hpp"

#include <algorithm>
#include <cstdint>

#include <boost/math/tools/toms748_solve.hpp>

namespace thimble {

namespace {

struct Point {
    double t_s;
    GapMotion::Sample sample;
};

// The later end of the last bracket: there the function has certainly changed sign. Needs a sign change.
template <class Function>
double root_between(const Function& function, double low_s, double high_s, double low, double high) {
    const boost::math::tools::eps_tolerance<double> tolerance(52);
    std::uintmax_t evaluations = 100;
    return boost::math::tools::toms748_solve(function, low_s, high_s, low, high, tolerance, evaluations)
        .second;
}

double rise_on_monotone(const GapMotion& gap, const Point& from, const Point& to) {
    if (to.sample.value_m <= 0 || to.sample.value_m <= from.sample.value_m) return kNoCrossing;
    if (from.sample.value_m >= 0) return from.t_s;
    const auto value = [&gap](double t_s) { return gap.at(t_s).value_m; };
    return root_between(value, from.t_s, to.t_s, from.sample.value_m, to.sample.value_m);
}

// The rate is monotone here: at most one turning point.
double rise_between_bends(const GapMotion& gap, const Point& from, const Point& to) {
    const double before = from.sample.rate_m_per_s;
    const double after = to.sample.rate_m_per_s;
    if (!((before < 0 && after > 0) || (before > 0 && after < 0))) return rise_on_monotone(gap, from, to);
    const auto rate = [&gap](double t_s) { return gap.at(t_s).rate_m_per_s; };
    const double turn_s = root_between(rate, from.t_s, to.t_s, before, after);
    const Point turn{turn_s, gap.at(turn_s)};
    const double rise_s = rise_on_monotone(gap, from, turn);
    return rise_s != kNoCrossing ? rise_s : rise_on_monotone(gap, turn, to);
}

}  // namespace

double first_rise(const GapMotion& gap, double duration_s) {
    const Inflections bends =
        gap.law->inflections(gap.velocity_surface_m_per_s, gap.acceleration_surface_m_per_s2);
    const Point last{duration_s, gap.at(duration_s)};
    Point from{0, gap.at(0.0)};
    double bend_s = bends.first_s;
    for (std::uint64_t bend = 1; from.t_s < duration_s; ++bend) {
        // Ends a long step of a surface whose oscillation has died away.
        if (cannot_rise(from.sample, last.sample, duration_s - from.t_s)) break;
        const Point to = bend_s < duration_s ? Point{bend_s, gap.at(bend_s)} : last;
        const double rise_s = rise_between_bends(gap, from, to);
        if (rise_s != kNoCrossing) return rise_s;
        from = to;
        bend_s = bends.first_s + static_cast<double>(bend) * bends.spacing_s;
    }
    return kNoCrossing;
}

}  // namespace thimble
