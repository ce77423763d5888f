// The brain of one subject in one trial: perception, behaviour and the noise of the hand, at 1 kHz. The body
// is the limb (limb.hpp), which the simulated handle integrates together with the device.
#pragma once

#include <cmath>

#include "master/operator/behaviour.hpp"
#include "master/operator/limb.hpp"
#include "master/operator/reflex.hpp"

namespace thimble {

// How stiff and how damped the limb is under load, as factors (HandMechanics). The load is what the relaxed arm would exert: with the
// stiffened one a load would raise itself.
class LoadedMuscles {
  public:
    explicit LoadedMuscles(const HandMechanics& hand)
        : stiffness_per_N_(hand.load_stiffness_per_N),
          damping_per_N_(hand.load_damping_per_N),
          gain_(-portable::expm1(-to_seconds(kBrainTick) / hand.load_lag_s)) {}

    // Once per brain tick.
    double follow(double exerted_N) { return load_N_ += gain_ * (exerted_N - load_N_); }
    double stiffness(double load_N) const { return 1 + stiffness_per_N_ * load_N; }
    double damping(double load_N) const { return 1 + damping_per_N_ * load_N; }

  private:
    double stiffness_per_N_, damping_per_N_, gain_;
    double load_N_ = 0;
};

class VirtualOperator {
  public:
    VirtualOperator(const OperatorParameters& parameters, const OperatorTask& task)
        : subject_(draw_subject(parameters, task.study_seed, task.experiment, task.subject)),
          tremor_m_(parameters.noise.tremor_m),
          force_noise_fraction_(parameters.noise.force_noise_fraction),
          load_(parameters.hand),
          reflex_(parameters.reflex),
          perception_(parameters.perception, subject_, task),
          behaviour_(parameters, subject_, task),
          sway_(stream_key(task, Purpose::kPositionNoise), parameters.noise.sway_correlation_s, kBrainTick),
          force_noise_(stream_key(task, Purpose::kForceNoise), parameters.noise.force_noise_correlation_s,
                       kBrainTick),
          tremor_(stream_key(task, Purpose::kTremor), parameters.noise.tremor_frequency_Hz,
                  parameters.noise.tremor_damping_ratio, kBrainTick) {}

    // One brain tick. The sensory side sees only the handle's force and the percept; `position_arm_m` sets
    // how hard the muscles pull, and with that their noise; it is also where the limb relaxes to.
    //     x_eq = x_cmd + sway + tremor + CV |x_cmd - x_a| n_F + reflex          (force noise divided by k_a)
    LimbCommand tick(double force_hand_N, const Percept& percept, double position_arm_m) {
        const Intention& intention = behaviour_.step(perception_.sense(force_hand_N, percept),
                                                     percept.touching_shown, percept.beep, position_arm_m);
        if (finished()) return {0, 0, intention.stiffness_factor};
        const double effort_m = std::fabs(intention.position_m - position_arm_m);
        double equilibrium_m = intention.position_m;
        equilibrium_m += subject_.sway_m * sway_.next();
        equilibrium_m += tremor_m_ * tremor_.next();
        equilibrium_m += force_noise_fraction_ * effort_m * force_noise_.next();
        equilibrium_m += reflex_.answer(position_arm_m, intention.position_m);
        const double load_N = load_.follow(subject_.arm_stiffness_N_per_m * effort_m);
        return {equilibrium_m, intention.velocity_m_per_s,
                intention.stiffness_factor * load_.stiffness(load_N), load_.damping(load_N)};
    }

    // Draws the noise of the next tick.
    void prepare() {
        sway_.prepare();
        tremor_.prepare();
        force_noise_.prepare();
    }

    const Subject& subject() const { return subject_; }
    const Behaviour& behaviour() const { return behaviour_; }
    double criterion_N() const { return perception_.criterion_N(); }
    bool finished() const { return behaviour_.phase() == BehaviourPhase::kDone; }

  private:
    Subject subject_;
    double tremor_m_, force_noise_fraction_;
    LoadedMuscles load_;
    StretchReflex reflex_;
    Perception perception_;
    Behaviour behaviour_;
    OrnsteinUhlenbeck sway_;
    OrnsteinUhlenbeck force_noise_;
    Tremor tremor_;
};

}  // namespace thimble
