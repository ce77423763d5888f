// Peer: Boost.odeint, Dormand-Prince 5 with step size control; events bracketed on its dense output.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>

#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint.hpp>

#include "bench/peers/peer_tissue.hpp"

namespace thimble {

inline constexpr double kFirstStep = 1e-4;  // s; step size control finds its own within a few steps

class OdeintTissue final : public PeerTissue {
  public:
    // tolerance > 0: absolute (m, m/s) and relative.
    OdeintTissue(const TissueParameters& parameters, double tolerance)
        : PeerTissue(parameters),
          stepper_(boost::numeric::odeint::make_dense_output(tolerance, tolerance, Rule())),
          natural_step_s_(kFirstStep) {
        assert(tolerance > 0);
    }

  protected:
    void start(double t_s, const Surface& surface) override {
        stepper_.initialize(State{surface.position_m, surface.velocity_m_per_s}, t_s, natural_step_s_);
    }

    // The stepper stands at the end of the last step; its first stage is of the old drive.
    void drive_changed() override {
        stepper_.initialize(stepper_.current_state(), stepper_.current_time(), natural_step_s_);
    }

    Arrival integrate(double from_s, double end_s) override {
        // A rounding error before the end is the end: a step that short would only confuse the control.
        const double enough_s = end_s - 4e-16 * std::abs(end_s);
        double checked_s = from_s;
        double checked_m = gap_m(from_s, surface_m_);
        while (true) {
            if (checked_s >= stepper_.current_time() && checked_s < enough_s) {
                step_on(end_s);
                check_effort();
            }
            const double to_s = stepper_.current_time() < enough_s ? stepper_.current_time() : end_s;
            const State y = at(to_s);
            const double to_m = gap_m(to_s, y[0]);
            if (to_m > 0 && checked_m <= 0) return crossing(checked_s, to_s);
            if (to_s == end_s) return {false, end_s, {y[0], y[1]}};
            checked_s = to_s;
            checked_m = to_m;
        }
    }

  private:
    using State = std::array<double, 2>;  // position, velocity
    using Rule = boost::numeric::odeint::runge_kutta_dopri5<State>;
    using Stepper = boost::numeric::odeint::result_of::make_dense_output<Rule>::type;

    // One step of the integrator, not beyond the end of the needle's where that matters.
    void step_on(double end_s) {
        const double left_s = end_s - stepper_.current_time();
        const double wanted_s = stepper_.current_time_step();
        const bool cut = !may_run_ahead() && wanted_s > left_s;
        if (cut) stepper_.initialize(stepper_.current_state(), stepper_.current_time(), left_s);
        stepper_.do_step([this](const State& y, State& slope, double /*t_s*/) {
            slope[0] = y[1];
            slope[1] = acceleration(y[0], y[1]);
        });
        // After a cut step the control knows no more than before, unless it had to shorten even that.
        const bool shortened = stepper_.current_time_step() < left_s;
        natural_step_s_ = cut && !shortened ? std::max(wanted_s, stepper_.current_time_step())
                                            : stepper_.current_time_step();
    }

    State at(double t_s) {
        if (t_s >= stepper_.current_time()) return stepper_.current_state();
        State y;
        stepper_.calc_state(t_s, y);
        return y;
    }

    // A surface that parts from the needle starts at a gap of zero: a little later it is below.
    Arrival crossing(double from_s, double to_s) {
        const auto gap = [this](double t_s) { return gap_m(t_s, at(t_s)[0]); };
        double low_s = from_s;
        if (gap(low_s) >= 0) low_s += (to_s - from_s) / 1024;
        const double low_m = gap(low_s);
        double t_s = from_s;
        if (low_m < 0) {
            std::uintmax_t evaluations = 100;
            t_s =
                boost::math::tools::toms748_solve(gap, low_s, to_s, low_m, gap(to_s),
                                                  boost::math::tools::eps_tolerance<double>(52), evaluations)
                    .second;
        }
        const State y = at(t_s);
        return {true, t_s, {y[0], y[1]}};
    }

    Stepper stepper_;
    double natural_step_s_;  // what the step size control wants, however short the step it was given
};

}  // namespace thimble
