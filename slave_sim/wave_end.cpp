#include "slave_sim/wave_end.hpp"

#include <algorithm>
#include <cmath>

namespace thimble {
namespace {

constexpr double kRejoinStep_m = 1e-4;  // per sample, at the hand

WaveChannelSettings channel_of(const WaveEndSettings& settings) {
    WaveChannelSettings channel = settings.channel;
    channel.sample_period_s = to_seconds(settings.sample_period);
    return channel;
}

}  // namespace

WaveEnd::WaveEnd(const WaveEndSettings& settings)
    : settings_(settings),
      slave_({settings.impedance_Ns_per_m, to_seconds(settings.sample_period), settings.damping_Ns_per_m}),
      sender_(channel_of(settings)),
      receiver_(channel_of(settings)) {}

void WaveEnd::reset() {
    sender_.reset();
    receiver_.reset(0);
    burst_ = {};
    placed_ = astray_ = false;
}

std::uint32_t WaveEnd::receive(const NeedleWave& message) {
    receiver_.receive(message.waves);
    const std::uint32_t number = message.waves.number;
    position_hand_m_ = message.command.position_hand_m;
    if (!placed_) {
        slave_.place(position_hand_m_);
        skip_to(number);
        placed_ = true;
    }
    if (number < next_) return 0;
    if (number - next_ >= kMostAtOnce) {
        skip_to(number - kMostAtOnce + 1);
        astray_ = true;
    }
    return number - next_ + 1;
}

// The master counts by its own samples: what answers number n is number n.
void WaveEnd::skip_to(std::uint32_t number) {
    next_ = number;
    sender_.skip_to(number);
}

double WaveEnd::step(double plane_needle_m, double stiffness_N_per_m, double other_force_N) {
    const double plane_hand_m = plane_needle_m / settings_.position_scale;
    const std::uint64_t missing = receiver_.missing();
    const double wave_root_W = receiver_.play(next_);
    astray_ = astray_ || receiver_.missing() > missing;
    if (astray_) rejoin(plane_hand_m);
    const WaveWall wall{plane_hand_m, settings_.force_scale * settings_.position_scale * stiffness_N_per_m};
    const double back_root_W =
        slave_.step(wave_root_W, wall, -settings_.force_scale * other_force_N, settings_.force_limit_N);
    burst_ = sender_.add(back_root_W);
    ++next_;
    return settings_.position_scale * slave_.position_m();
}

void WaveEnd::rejoin(double plane_hand_m) {
    if (std::max(slave_.position_m(), position_hand_m_) >= plane_hand_m) return;
    const double away_m = position_hand_m_ - slave_.position_m();
    slave_.place(slave_.position_m() + std::clamp(away_m, -kRejoinStep_m, kRejoinStep_m));
    astray_ = std::fabs(away_m) > kRejoinStep_m;
}

}  // namespace thimble
