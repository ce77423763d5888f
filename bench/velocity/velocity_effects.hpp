// The effect of a velocity estimator on the system behind it: the simulated slave is driven through the estimator
// and, as the ideal, with the needle's true position.
#pragma once

#include "bench/velocity/velocity_measures.hpp"

namespace thimble {

// Slow presses at 5, 10 and 15 mm/s. The true needle pierces late, when K x + B v reaches F_p.
struct PressEffect {
    int presses = 0;
    int false_punctures = 0;         // within a millimetre of touch
    double depth_error_mean_m = 0;   // of the needle at the puncture; negative: too early
    double depth_error_worst_m = 0;  // the largest by magnitude, its sign kept
    double ideal_depth_m = 0;        // mean
    double contact_force_noise_N =
        0;  // rms of the force against the ideal, from touch to puncture at 10 mm/s;
            // NaN if no press holds for a quarter of a second
};

// Entry at 60 mm/s: the true needle touches and pierces at once.
struct EntryEffect {
    double depth_error_m = 0;  // of the needle at the puncture
    double transitions = 0;    // of the tissue within 0.2 s of touch, mean; 2 are needed
    double ideal_transitions = 0;
    double force_noise_N = 0;  // rms against the ideal from 0.5 s to 1 s after touch
};

// A fixture that also damps, F = -K p - B v with B = 5 N s/m at the needle; only B v passes through the estimator.
// Tremor of 10 Hz within it.
struct FixtureEffect {
    double damping_noise_N = 0;          // rms beside the 10 Hz sine
    double damping_kept = 0;             // share of B that works as damping at 10 Hz: gain x cos(phase lag)
    double added_stiffness_N_per_m = 0;  // what the rest of it does instead: B w gain sin(phase lag)
};

PressEffect measure_presses(const VelocitySettings& settings, const VelocityStudy& study);
EntryEffect measure_entry(const VelocitySettings& settings, const VelocityStudy& study);
FixtureEffect fixture_effect(const TremorResponse& tremor);

}  // namespace thimble
