#include "master/operator/virtual_operator.hpp"

#include <cmath>

namespace thimble {

VirtualOperator::VirtualOperator(const OperatorParameters& parameters, const OperatorTask& task)
    : subject_(draw_subject(parameters, task.study_seed, task.experiment, task.subject)),
      tremor_m_(parameters.noise.tremor_m),
      force_noise_fraction_(parameters.noise.force_noise_fraction),
      perception_(parameters.perception, subject_, task),
      behaviour_(parameters, subject_, task),
      sway_(stream_key(task, Purpose::kPositionNoise), parameters.noise.sway_correlation_s, kBrainTick),
      force_noise_(stream_key(task, Purpose::kForceNoise), parameters.noise.force_noise_correlation_s,
                   kBrainTick),
      tremor_(stream_key(task, Purpose::kTremor), parameters.noise.tremor_frequency_Hz,
              parameters.noise.tremor_damping_ratio, kBrainTick) {}

LimbCommand VirtualOperator::tick(double force_hand_N, const Percept& percept, double position_arm_m) {
    const Intention& intention = behaviour_.step(perception_.sense(force_hand_N, percept),
                                                 percept.touching_shown, percept.beep, position_arm_m);
    if (finished()) return {0, 0, intention.stiffness_factor};
    const double effort_m = std::fabs(intention.position_m - position_arm_m);
    double equilibrium_m = intention.position_m;
    equilibrium_m += subject_.sway_m * sway_.next();
    equilibrium_m += tremor_m_ * tremor_.next();
    equilibrium_m += force_noise_fraction_ * effort_m * force_noise_.next();
    return {equilibrium_m, intention.velocity_m_per_s, intention.stiffness_factor};
}

}  // namespace thimble
