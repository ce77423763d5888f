#include "slave_sim/stepped_tissue.hpp"

#include <cassert>
#include <cmath>

#include "common/error.hpp"
#include "common/math/portable.hpp"

namespace thimble {

namespace {

double acceleration(const SurfaceLaw& law, const SurfaceMotion& at) {
    return law.drive_m_per_s2 - law.damping_per_s * at.velocity_m_per_s -
           law.stiffness_per_s2 * at.position_m;
}

SurfaceLaw law_of(const TissueParameters& p, bool penetrated, double velocity_needle_m_per_s) {
    const double drag = penetrated ? p.drag_Ns_per_m : 0;
    return {drag * velocity_needle_m_per_s / p.mass_kg, (p.damping_Ns_per_m + drag) / p.mass_kg,
            p.stiffness_N_per_m / p.mass_kg};
}

// A rule is linear in position and velocity: one step is a 2 x 2 matrix, and bounded motion needs both of
// its eigenvalues within the unit circle (the conditions of Jury). Some room for rounding: an undamped
// surface stepped by the implicit midpoint lies on the circle.
template <class Rule>
bool stable(const TissueParameters& p, double h) {
    for (const bool penetrated : {false, true}) {
        const SurfaceLaw law = law_of(p, penetrated, 0);
        // With velocity in units of the motion's own speed, so that both columns are of one size.
        const double unit_per_s = std::sqrt(law.stiffness_per_s2) + law.damping_per_s + 1 / h;
        const SurfaceMotion a = Rule::advance(law, {1, 0}, h);
        const SurfaceMotion b = Rule::advance(law, {0, unit_per_s}, h);
        const double trace = a.position_m + b.velocity_m_per_s / unit_per_s;
        const double determinant =
            (a.position_m * b.velocity_m_per_s - a.velocity_m_per_s * b.position_m) / unit_per_s;
        constexpr double kRounding = 1e-9;
        if (!(std::abs(determinant) <= 1 + kRounding && std::abs(trace) <= 1 + determinant + kRounding)) {
            return false;
        }
    }
    return true;
}

template <class Rule>
double longest_stable_step_s(const TissueParameters& p, double unstable_s) {
    double low_s = 0;
    double high_s = unstable_s;
    // Bisects on a logarithmic scale: the stable step may be a billionth of the first guess.
    for (low_s = unstable_s / 2; low_s > 0 && !stable<Rule>(p, low_s); low_s /= 2) high_s = low_s;
    for (int i = 0; i < 20; ++i) {
        const double middle_s = low_s + (high_s - low_s) / 2;
        (stable<Rule>(p, middle_s) ? low_s : high_s) = middle_s;
    }
    return low_s;
}

// To three digits, downwards: the step that an error advises must be one that is taken.
double rounded_down(double value) {
    const double unit = portable::pow(10, std::floor(portable::log10(value)) - 2);
    return std::floor(value / unit) * unit;
}

}  // namespace

SurfaceMotion SemiImplicitEuler::advance(const SurfaceLaw& law, const SurfaceMotion& from, double h) {
    const double v = from.velocity_m_per_s + h * acceleration(law, from);
    return {from.position_m + h * v, v};
}

SurfaceMotion RungeKutta4::advance(const SurfaceLaw& law, const SurfaceMotion& from, double h) {
    const auto slope = [&law](const SurfaceMotion& at) {
        return SurfaceMotion{at.velocity_m_per_s, acceleration(law, at)};
    };
    const auto along = [&from](const SurfaceMotion& k, double t) {
        return SurfaceMotion{from.position_m + t * k.position_m,
                             from.velocity_m_per_s + t * k.velocity_m_per_s};
    };
    const SurfaceMotion k1 = slope(from);
    const SurfaceMotion k2 = slope(along(k1, h / 2));
    const SurfaceMotion k3 = slope(along(k2, h / 2));
    const SurfaceMotion k4 = slope(along(k3, h));
    const auto mean = [](double a, double b, double c, double d) { return (a + 2 * (b + c) + d) / 6; };
    return along({mean(k1.position_m, k2.position_m, k3.position_m, k4.position_m),
                  mean(k1.velocity_m_per_s, k2.velocity_m_per_s, k3.velocity_m_per_s, k4.velocity_m_per_s)},
                 h);
}

// a_m = a(x + h/2 v_m, v_m) with v_m = v + h/2 a_m is linear in a_m.
SurfaceMotion ImplicitMidpoint::advance(const SurfaceLaw& law, const SurfaceMotion& from, double h) {
    const double half = h / 2;
    const SurfaceMotion drifted{from.position_m + half * from.velocity_m_per_s, from.velocity_m_per_s};
    const double a =
        acceleration(law, drifted) / (1 + half * (law.damping_per_s + half * law.stiffness_per_s2));
    const double v_middle = from.velocity_m_per_s + half * a;
    return {from.position_m + h * v_middle, from.velocity_m_per_s + h * a};
}

template <class Rule>
SteppedTissue<Rule>::SteppedTissue(const TissueParameters& parameters, double longest_step_s)
    : TissueSolver(parameters), longest_step_s_(longest_step_s) {
    assert(longest_step_s > 0);
    if (stable<Rule>(parameters, longest_step_s)) return;
    throw Error(ExitCode::kUsage,
                "solver {} is unstable at a step of {:g} s for a tissue of {:g} kg, {:g} N/m and {:g} N s/m: "
                "use at most {:.3g} s, or the solver exact",
                Rule::kName, longest_step_s, parameters.mass_kg, parameters.stiffness_N_per_m,
                parameters.damping_Ns_per_m,
                rounded_down(longest_stable_step_s<Rule>(parameters, longest_step_s)));
}

template <class Rule>
void SteppedTissue<Rule>::move(double duration_s, double needle_end_m, Transitions& transitions) {
    // A step that is a rounding error longer is not two.
    const double parts = std::fmax(1, std::ceil(duration_s / longest_step_s_ * (1 - 1e-9)));
    const double h = duration_s / parts;
    const double start_m = needle_m_;
    for (double i = 1; i <= parts; ++i) {
        needle_m_ = i < parts ? start_m + (needle_end_m - start_m) * (i / parts) : needle_end_m;
        if (phase_ == TissuePhase::kContact) {
            surface_m_ = needle_m_;
            velocity_surface_m_per_s_ = velocity_needle_m_per_s_;
        } else {
            const SurfaceLaw law =
                law_of(parameters_, phase_ == TissuePhase::kPenetrated, velocity_needle_m_per_s_);
            const SurfaceMotion to = Rule::advance(law, {surface_m_, velocity_surface_m_per_s_}, h);
            evaluations_ += Rule::kStages;
            surface_m_ = to.position_m;
            velocity_surface_m_per_s_ = to.velocity_m_per_s;
        }
        obey_guards(i < parts ? i * h : duration_s, transitions);
    }
}

template <class Rule>
void SteppedTissue<Rule>::obey_guards(double offset_s, Transitions& transitions) {
    if (phase_ == TissuePhase::kPenetrated) {
        if (needle_m_ < surface_m_) enter(TissuePhase::kFree, offset_s, transitions);
        return;
    }
    if (phase_ == TissuePhase::kFree) {
        if (needle_m_ <= surface_m_) return;
        enter(TissuePhase::kContact, offset_s, transitions);
    }
    const double force_N = contact_force_N(needle_m_, velocity_needle_m_per_s_);
    if (force_N < 0) {
        enter(TissuePhase::kFree, offset_s, transitions);
    } else if (force_N > parameters_.puncture_force_N) {
        enter(TissuePhase::kPenetrated, offset_s, transitions);
    }
}

template <class Rule>
void SteppedTissue<Rule>::enter(TissuePhase phase, double offset_s, Transitions& transitions) {
    if (phase == TissuePhase::kContact) {
        surface_m_ = needle_m_;
        velocity_surface_m_per_s_ = velocity_needle_m_per_s_;
    }
    phase_ = phase;
    transitions.push(offset_s, to_string(phase));
}

template class SteppedTissue<SemiImplicitEuler>;
template class SteppedTissue<RungeKutta4>;
template class SteppedTissue<ImplicitMidpoint>;

}  // namespace thimble
