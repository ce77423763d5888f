// A subject without chance: every draw gives its median, so that instants and distances can be checked
// exactly.
#pragma once

#include "master/operator/virtual_operator.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble::test {

inline constexpr Sensation kNothing{.signal_N = 0, .contact_lost = true};
inline constexpr Sensation kFixture{.signal_N = 3, .fixture_felt = true};

inline OperatorParameters calm_parameters() {
    OperatorParameters parameters;
    parameters.spread = {0, 0, 0, 0, 0, 0, 0, 0, 0};
    parameters.noise.sway_m = parameters.noise.tremor_m = 0;
    parameters.noise.force_noise_fraction = parameters.noise.speed_noise_fraction = 0;
    parameters.behaviour.speed_trial_variation = 0;
    parameters.reaction.trial_variation = 0;
    parameters.perception.weber_handle = parameters.perception.weber_cutaneous = 0;
    parameters.perception.weber_visual = 0;
    return parameters;
}

inline OperatorTask task_of(Modality modality, std::uint32_t subject = 1, std::uint32_t experiment = 1) {
    return {.study_seed = 7, .experiment = experiment, .subject = subject, .trial = 1, .modality = modality};
}

}  // namespace thimble::test
