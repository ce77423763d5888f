// Peer: Boost.odeint, Dormand-Prince 5 with step size control; events bracketed on its dense output.
#pragma once

#include <array>

#include <boost/numeric/odeint.hpp>

#include "bench/peers/peer_tissue.hpp"

namespace thimble {

class OdeintTissue final : public PeerTissue {
  public:
    // tolerance > 0: absolute (m, m/s) and relative.
    OdeintTissue(const TissueParameters& parameters, double tolerance);

  protected:
    void start(double t_s, const Surface& surface) override;
    void drive_changed() override;
    Arrival integrate(double from_s, double end_s) override;

  private:
    using State = std::array<double, 2>;  // position, velocity
    using Rule = boost::numeric::odeint::runge_kutta_dopri5<State>;
    using Stepper = boost::numeric::odeint::result_of::make_dense_output<Rule>::type;

    void step_on(double end_s);
    State at(double t_s);
    Arrival crossing(double from_s, double to_s);

    Stepper stepper_;
    double natural_step_s_;  // what the step size control wants, however short the step it was given
};

}  // namespace thimble
