// The brain of one subject in one trial: perception, behaviour and the noise of the hand, at 1 kHz. The body
// is the limb (limb.hpp), which the simulated handle integrates together with the device.
#pragma once

#include "master/operator/behaviour.hpp"
#include "master/operator/limb.hpp"

namespace thimble {

class VirtualOperator {
  public:
    VirtualOperator(const OperatorParameters& parameters, const OperatorTask& task);

    // One brain tick. The sensory side sees only the handle's force and the percept; `position_arm_m` sets
    // how hard the muscles pull, and with that their noise; it is also where the limb relaxes to.
    //     x_eq = x_cmd + sway + tremor + CV |x_cmd - x_a| n_F          (force noise divided by k_a)
    LimbCommand tick(double force_hand_N, const Percept& percept, double position_arm_m);

    const Subject& subject() const { return subject_; }
    const Behaviour& behaviour() const { return behaviour_; }
    double criterion_N() const { return perception_.criterion_N(); }
    bool finished() const { return behaviour_.phase() == BehaviourPhase::kDone; }

  private:
    Subject subject_;
    double tremor_m_, force_noise_fraction_;
    Perception perception_;
    Behaviour behaviour_;
    OrnsteinUhlenbeck sway_;
    OrnsteinUhlenbeck force_noise_;
    Tremor tremor_;
};

}  // namespace thimble
