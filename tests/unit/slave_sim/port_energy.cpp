#include "tests/unit/slave_sim/port_energy.hpp"

#include <algorithm>
#include <cmath>

#include <boost/math/quadrature/gauss.hpp>

#include "tests/unit/slave_sim/phases.hpp"

namespace thimble {

PortEnergy::PortEnergy(const TissueParameters& p, double position_needle_m)
    : parameters_(p),
      laws_{SecondOrder(p.mass_kg, p.damping_Ns_per_m, p.stiffness_N_per_m),
            SecondOrder(p.mass_kg, p.damping_Ns_per_m + p.drag_Ns_per_m, p.stiffness_N_per_m)},
      needle_m_(position_needle_m - p.rest_position_m) {}

void PortEnergy::add(double& sum_J, double part_J) {
    sum_J += part_J;
    turnover_J_ += std::abs(part_J);
}

double PortEnergy::stored_J() const {
    return 0.5 * (parameters_.stiffness_N_per_m * surface_m_ * surface_m_ +
                  parameters_.mass_kg * velocity_surface_m_per_s_ * velocity_surface_m_per_s_);
}

// The needle makes the surface move at its own velocity, without work.
void PortEnergy::carry(double velocity_m_per_s) {
    const double v = velocity_surface_m_per_s_;
    const double gift_J = 0.5 * parameters_.mass_kg * (velocity_m_per_s * velocity_m_per_s - v * v);
    add(given_J_, gift_J);
    gifts_J_ += std::max(0.0, gift_J);
    velocity_surface_m_per_s_ = velocity_m_per_s;
}

void PortEnergy::enter(TissuePhase phase) {
    phase_ = phase;
    if (phase == TissuePhase::kContact) {
        // The gap is zero up to rounding: move the surface there without forgetting its spring.
        const double before_J = stored_J();
        surface_m_ = needle_m_;
        add(given_J_, stored_J() - before_J);
        carry(velocity_needle_m_per_s_);
    }
}

void PortEnergy::step(double duration_s, double position_needle_m, const Transitions& transitions) {
    const double end_m = position_needle_m - parameters_.rest_position_m;
    velocity_needle_m_per_s_ = (end_m - needle_m_) / duration_s;
    if (phase_ == TissuePhase::kContact) carry(velocity_needle_m_per_s_);
    const double start_m = needle_m_;
    double since_s = 0;
    for (const Transition& t : transitions) {
        leg(t.offset_s - since_s, start_m + velocity_needle_m_per_s_ * t.offset_s);
        since_s = t.offset_s;
        enter(phase_named(t.phase));
    }
    leg(duration_s - since_s, end_m);
}

void PortEnergy::leg(double duration_s, double needle_end_m) {
    const double v = velocity_needle_m_per_s_;
    const double before_m = surface_m_;
    dissipate(duration_s);
    if (phase_ == TissuePhase::kContact) {
        surface_m_ = needle_end_m;
        const double stiffness = parameters_.stiffness_N_per_m;
        add(work_J_, 0.5 * stiffness * (surface_m_ - before_m) * (surface_m_ + before_m));
        add(work_J_, parameters_.damping_Ns_per_m * v * (surface_m_ - before_m));
    } else {
        const bool penetrated = phase_ == TissuePhase::kPenetrated;
        const SecondOrder& law = laws_[penetrated];
        const double drive_N = penetrated ? parameters_.drag_Ns_per_m * v : 0;
        const double a = law.acceleration(drive_N, surface_m_, velocity_surface_m_per_s_);
        const Propagator p = law.propagator(duration_s);
        const double moved_m = p.moved_m(velocity_surface_m_per_s_, a);
        if (penetrated) add(work_J_, parameters_.drag_Ns_per_m * v * (v * duration_s - moved_m));
        surface_m_ += moved_m;
        velocity_surface_m_per_s_ = p.velocity_after_m_per_s(velocity_surface_m_per_s_, a);
    }
    needle_m_ = needle_end_m;
}

double PortEnergy::loss_W(double velocity_surface_m_per_s) const {
    const double v = velocity_surface_m_per_s;
    const double slip = v - velocity_needle_m_per_s_;
    const double drag = phase_ == TissuePhase::kPenetrated ? parameters_.drag_Ns_per_m : 0;
    return parameters_.damping_Ns_per_m * v * v + drag * slip * slip;
}

// Twenty points of Gauss for each radian or time constant: beyond double precision for damped exponentials. A
// surface that does not swing varies ever more slowly, and one that has swung for 50 time constants rests.
void PortEnergy::dissipate(double duration_s) {
    const bool penetrated = phase_ == TissuePhase::kPenetrated;
    const SecondOrder& law = laws_[penetrated];
    const TissueParameters& p = parameters_;
    const double drag = penetrated ? p.drag_Ns_per_m : 0;
    const double v = velocity_surface_m_per_s_;
    const double a = law.acceleration(drag * velocity_needle_m_per_s_, surface_m_, v);
    const auto loss = [&](double t_s) {
        if (phase_ == TissuePhase::kContact) return loss_W(velocity_needle_m_per_s_);
        return loss_W(law.propagator(t_s).velocity_after_m_per_s(v, a));
    };
    const double damping_per_s = (p.damping_Ns_per_m + drag) / p.mass_kg;
    const double natural_per_s = std::sqrt(p.stiffness_N_per_m / p.mass_kg);
    const bool swings = damping_per_s < 2 * natural_per_s;
    double part_s = 1 / (damping_per_s + natural_per_s + 1e-9);
    for (double from_s = 0; from_s < duration_s;) {
        const double to_s = std::min(duration_s, from_s + part_s);
        add(dissipated_J_, boost::math::quadrature::gauss<double, 20>::integrate(loss, from_s, to_s));
        if (!swings || damping_per_s * to_s > 100) part_s *= 2;
        from_s = to_s;
    }
}

}  // namespace thimble
