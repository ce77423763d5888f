#include "common/control/wave_variables.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "common/error.hpp"

namespace thimble {
namespace {

const WaveSettings& checked(const WaveSettings& settings) {
    check_wave_settings(settings);
    return settings;
}

}  // namespace

void check_wave_settings(const WaveSettings& settings) {
    const auto good = [](double value) { return std::isfinite(value) && value > 0; };
    if (good(settings.impedance_Ns_per_m) && good(settings.sample_period_s) &&
        settings.slave_damping_Ns_per_m >= 0)
        return;
    throw Error(ExitCode::kUsage,
                "wave variables need an impedance and a sample period above 0 and finite, not " +
                    std::to_string(settings.impedance_Ns_per_m) + " Ns/m and " +
                    std::to_string(settings.sample_period_s) + " s");
}

WaveMaster::WaveMaster(const WaveSettings& settings)
    : settings_(checked(settings)), root_2b_(std::sqrt(2 * settings.impedance_Ns_per_m)) {}

double WaveMaster::wave_out(double position_hand_m, double force_held_N) {
    if (!std::isfinite(position_hand_m)) position_hand_m = position_hand_m_;
    if (!std::isfinite(force_held_N)) force_held_N = 0;
    velocity_m_per_s_ = placed_ ? (position_hand_m - position_hand_m_) / settings_.sample_period_s : 0;
    position_hand_m_ = position_hand_m;
    placed_ = true;
    return (settings_.impedance_Ns_per_m * velocity_m_per_s_ + force_held_N) / root_2b_;
}

double WaveMaster::force_N(double wave_in_root_W) const {
    return settings_.impedance_Ns_per_m * velocity_m_per_s_ - root_2b_ * wave_in_root_W;
}

WaveSlave::WaveSlave(const WaveSettings& settings)
    : settings_(checked(settings)),
      root_2b_(std::sqrt(2 * settings.impedance_Ns_per_m)),
      root_2_per_b_(std::sqrt(2 / settings.impedance_Ns_per_m)) {}

double WaveSlave::step(double wave_in_root_W, const WaveWall& wall, double other_N, double force_limit_N) {
    const double h_s = settings_.sample_period_s, b_s = settings_.slave_damping_Ns_per_m;
    const double mobility_m_per_N = h_s / settings_.impedance_Ns_per_m;  // h / b
    const double drive_m = root_2b_ * wave_in_root_W * mobility_m_per_N;
    // With the damper: how far it would go without the wall, and how far a newton then moves it.
    const double softer = 1 / (1 + b_s / settings_.impedance_Ns_per_m);
    const double beyond_m = position_m_ + softer * (drive_m - other_N * mobility_m_per_N) - wall.position_m;
    const double wall_N =
        beyond_m > 0 ? beyond_m / (softer * mobility_m_per_N + 1 / wall.stiffness_N_per_m) : 0;
    const double travel_m = softer * (drive_m - (other_N + wall_N) * mobility_m_per_N);
    const double force = other_N + wall_N + b_s * travel_m / h_s;
    force_N_ = std::clamp(force, -force_limit_N, force_limit_N);
    position_m_ += drive_m - force_N_ * mobility_m_per_N;
    return wave_in_root_W - root_2_per_b_ * force_N_;
}

}  // namespace thimble
