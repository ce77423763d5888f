// Which velocity estimator a session's configuration file chooses, and its numbers.
#pragma once

#include <algorithm>

#include "common/config.hpp"
#include "common/velocity_estimator.hpp"

namespace thimble {

inline constexpr double kEncoderStep_hand_m = 1e-5;

// The keys velocity_* of table [master]. Throws Error (usage), also for a number that the chosen estimator does
// not use: it would be without effect. The quantum's default is the paper's encoder seen at the needle,
// position_scale x 0.01 mm.
inline VelocitySettings read_velocity_settings(const ConfigTable& table, Duration sample_period,
                                               double position_scale) {
    VelocitySettings v;
    v.sample_period = sample_period;
    v.window = std::max(v.window, sample_period);
    v.quantum_m = position_scale * kEncoderStep_hand_m;
    table.read("velocity_estimator", v.method, kVelocityMethodNames,
               "Method that estimates the needle's velocity (docs/speed.md). In HF with a controller of two "
               "ends (wave, two-port, four-channel) the tissue follows slave_sim's own estimate.");
    const auto only = [&](std::vector<std::string_view> users) {
        const std::string_view chosen = kVelocityMethodNames[static_cast<std::size_t>(v.method)];
        return table.only_with("velocity_estimator", chosen, std::move(users));
    };
    only({"low_pass"})
        .read("velocity_time_constant_s", v.time_constant, 0, 1,
              "Time constant of the filter; 0: raw differences.");
    only({"windowed", "foaw"})
        .read("velocity_window_s", v.window, to_seconds(sample_period), 1,
              "Length of the window, 1 to 255 samples; for foaw the longest one.");
    only({"foaw"}).read("velocity_foaw_fit", v.fit, {"best", "end"},
                        "best: least squares; end: difference of newest and oldest sample.");
    only({"foaw", "kalman"})
        .read("velocity_quantum_needle_m", v.quantum_m, 1e-9, 0.1,
              "Encoder step at the needle; default position_scale x 1e-5.");
    only({"kalman"})
        .read("velocity_process_noise_m2_per_s3", v.acceleration_noise_m2_per_s3, 1e-9, 1e6,
              "Density of the needle's acceleration; more is faster and noisier.");
    constexpr std::size_t kMost = SampleWindow::kCapacity - 1;
    if (v.window > static_cast<std::int64_t>(kMost) * sample_period) {
        table.fail("velocity_window_s",
                   "must be at most {} times sample_period_s, because only this number of samples is kept",
                   kMost);
    }
    return v;
}

}  // namespace thimble
