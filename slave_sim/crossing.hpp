// The first instant at which the needle passes the surface, found exactly however long the step.
//
// The gap is a line (the needle) minus the motion of the surface. Its second derivative has zeros in closed
// form; between two of them the first derivative is monotone and has at most one zero; between two of those
// the gap is monotone and has at most one. So no root is stepped over and none is found twice.
#pragma once

#include <cstdint>
#include <limits>

#include "slave_sim/second_order.hpp"

namespace thimble {

inline constexpr double kNoCrossing = -1;
inline constexpr double kUnsearched = -2;  // the search was given up

// side * (needle - surface) after t seconds. side = +1 asks for a needle that enters, -1 for one that leaves:
// the event is always a rise above zero.
class GapMotion {
  public:
    struct Sample {
        double value_m;
        double rate_m_per_s;
        double curvature_bound_m_per_s2;  // of |gap''| from t on
    };

    double side = 1;
    double gap_m = 0;  // needle - surface at t = 0
    double velocity_needle_m_per_s = 0;
    double velocity_surface_m_per_s = 0;
    double acceleration_surface_m_per_s2 = 0;
    const SecondOrder* law = nullptr;
    // A surface can swing 1e12 times within reach of the needle: a search that costs more is given up.
    std::uint64_t most_propagators = std::numeric_limits<std::uint64_t>::max();
    mutable std::uint64_t propagators = 0;  // computed so far: what a search costs

    Sample at(const Propagator& p) const;
    Sample at(double t_s) const {
        ++propagators;
        return at(law->propagator(t_s));
    }
};

inline GapMotion::Sample GapMotion::at(const Propagator& p) const {
    const double v = velocity_surface_m_per_s;
    const double a = acceleration_surface_m_per_s2;
    const double t = p.duration_s;
    // As changes since t = 0, so that a gap that starts at zero keeps its digits.
    const double moved_m = velocity_needle_m_per_s * t - p.moved_m(v, a);
    const double slowed_m_per_s =
        law->stiffness_per_s2() * p.position_per_acceleration_s2 * v - p.velocity_per_acceleration_s * a;
    const double rate_m_per_s = (velocity_needle_m_per_s - v) + slowed_m_per_s;
    const double bound_m_per_s2 =
        law->acceleration_bound(v - slowed_m_per_s, law->acceleration_after(p, v, a));
    return {side * (gap_m + moved_m), side * rate_m_per_s, bound_m_per_s2};
}

// Cheap and conservative: true only if no rise above zero can happen between two samples `apart_s` apart.
inline bool cannot_rise(const GapMotion::Sample& from, const GapMotion::Sample& to, double apart_s) {
    const double bend_m_per_s = from.curvature_bound_m_per_s2 * apart_s;
    const double highest_m = from.value_m > to.value_m ? from.value_m : to.value_m;
    // A curve leaves its chord by at most |gap''| t^2 / 8.
    if (highest_m + bend_m_per_s * apart_s * 0.125 < 0) return true;
    return from.value_m <= 0 && from.rate_m_per_s + bend_m_per_s <= 0;
}

// Time of the first rise above zero within (0, duration], 0 if the gap stands at zero or above and rises at
// once, kNoCrossing if there is none, kUnsearched if that would cost too much to say. A gap at zero that
// falls or rests is no event.
double first_rise(const GapMotion& gap, double duration_s);

}  // namespace thimble
