// Noise and lag of a velocity estimator, measured against needles whose velocity is known.
#pragma once

#include <vector>

#include "bench/velocity/needle_path.hpp"
#include "common/velocity_estimator.hpp"

namespace thimble {

// The ranges of the study.
struct VelocityStudy {
    NeedleEncoder encoder;
    std::uint64_t seed = 1;
    int repeats = 32;  // of each steady motion, each from another place within the quantum

    RandomStream random(std::uint32_t part) const {
        return RandomStream({seed, 0, part, 0, Purpose::kTremor});
    }
};

struct VelocityQuality {
    // On lines at 2, 5, 10, 20, 60 and 100 mm/s, where lag does not show.
    double noise_rms_m_per_s = 0;
    double noise_peak_m_per_s = 0;
    // On the reach: the delay of the true velocity that fits best, the error it leaves, the error without it.
    double lag_s = 0;
    double residual_rms_m_per_s = 0;
    double error_rms_m_per_s = 0;
};

// Response to an oscillation of the tremor's size at 10 Hz: v_est = gain x true, later by phase_lag.
struct TremorResponse {
    double gain = 0;
    double phase_lag_rad = 0;
    double noise_rms_m_per_s = 0;  // what is left beside that sine
};

// A needle's samples through an estimator, as the master feeds it.
std::vector<VelocityEstimator::Estimate> estimate(const VelocitySettings& settings,
                                                  const SampledNeedle& needle);

VelocityQuality measure_quality(const VelocitySettings& settings, const VelocityStudy& study);
TremorResponse measure_tremor(const VelocitySettings& settings, const VelocityStudy& study);
// Of one update, the fastest of several runs over a reach: neighbours on the machine only make it slower.
double measure_cost_s(const VelocitySettings& settings, const VelocityStudy& study);

}  // namespace thimble
