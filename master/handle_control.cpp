#include "master/handle_control.hpp"

#include <algorithm>

#include "common/control/energy_bound.hpp"
#include "common/control/passivity_controller.hpp"

namespace thimble {
namespace {

std::unique_ptr<PortCompensator> make_port_compensator(const ControlSettings& s, double period_s) {
    const PortSettings port{period_s, s.device_damping_Ns_per_m};
    switch (s.compensator) {
        case Compensator::kPassivity:
            return std::make_unique<PassivityController>(port, s.most_damping_Ns_per_m);
        case Compensator::kMemorylessBound:
            return std::make_unique<MemorylessBound>(port);
        case Compensator::kLeastConservative:
            return std::make_unique<LeastConservativeBound>(port);
        case Compensator::kTwoLayer:
            return std::make_unique<TwoLayerTank>(port, s.tank);
        default:
            return nullptr;
    }
}

LocalFixtureSettings with_period(LocalFixtureSettings settings, double period_s) {
    settings.sample_period_s = period_s;
    return settings;
}

}  // namespace

HandleControl::HandleControl(const ControlSettings& settings, const HandleControlScale& scale)
    : settings_(settings),
      scale_(scale),
      port_(make_port_compensator(settings, to_seconds(scale.sample_period))),
      local_(with_period(settings.local, to_seconds(scale.sample_period))),
      waves_(make_waves(settings, to_seconds(scale.sample_period))) {
    if (settings.compensator != Compensator::kTwoPort) return;
    const PortSettings port{to_seconds(scale.sample_period), settings.device_damping_Ns_per_m};
    two_port_.emplace(port, settings.most_damping_Ns_per_m);
}

std::unique_ptr<HandleControl::Waves> HandleControl::make_waves(const ControlSettings& settings,
                                                                double period_s) {
    if (settings.compensator != Compensator::kWave) return nullptr;
    WaveChannelSettings channel = settings.channel;
    channel.sample_period_s = period_s;
    return std::make_unique<Waves>(Waves{WaveMaster({settings.wave_impedance_Ns_per_m, period_s}),
                                         WaveSender(channel), WaveReceiver(channel)});
}

void HandleControl::start(bool kinesthetic, Duration network_delay) {
    active_ = kinesthetic && settings_.compensator != Compensator::kNone &&
              settings_.compensator != Compensator::kScaled;
    if (port_) port_->reset();
    local_.reset();
    sampled_before_ = false;
    asked_N_ = 0;
    burst_ = {};
    energy_heard_J_ = 0;
    if (two_port_) two_port_->reset();
    if (!waves_) return;
    waves_->master.reset();
    waves_->sender.reset();
    waves_->receiver.reset(play_out_samples(network_delay));
    waves_->in_root_W = 0;
}

void HandleControl::network_changed(Duration network_delay) {
    if (waves_) waves_->receiver.play_out_after(play_out_samples(network_delay));
}

// The answer to a sample cannot count for that sample: at least one.
std::uint32_t HandleControl::play_out_samples(Duration network_delay) const {
    const Duration wait = network_delay + settings_.jitter;
    const auto samples = (wait + scale_.sample_period - Duration{1}) / scale_.sample_period;
    return std::max(1U, static_cast<std::uint32_t>(samples) + settings_.channel.repeats);
}

void HandleControl::sample(SessionTime now, const HandleSample& handle) {
    const double elapsed_s = sampled_before_ ? to_seconds(now - sampled_) : 0;
    sampled_ = now;
    sampled_before_ = true;
    position_hand_m_ = handle.position_hand_m;
    if (port_) port_->observe(elapsed_s, handle.position_hand_m, handle.force_hand_N);
    if (two_port_) {
        two_port_->observe(handle.position_hand_m, handle.force_hand_N);
        burst_.energy_J = two_port_->energy_in_J();
    }
    if (!waves_) return;
    burst_ = waves_->sender.add(waves_->master.wave_out(handle.position_hand_m, handle.force_hand_N));
    waves_->in_root_W = waves_->receiver.play(burst_.number);
}

void HandleControl::take(const WaveBurst& waves) {
    energy_heard_J_ = waves.energy_J;
    if (waves_) waves_->receiver.receive(waves);
}

void HandleControl::take(const ForceFeedback& feedback) {
    if (feedback.needle_held) return forget();
    if (settings_.compensator != Compensator::kLocalFixture) {
        asked_N_ = -scale_.force_scale * feedback.force_total_N;
        return;
    }
    local_.learn(feedback.position_needle_m / scale_.position_scale,
                 -scale_.force_scale * feedback.force_fixture_N);
    asked_N_ = -scale_.force_scale * feedback.force_tissue_N;
}

void HandleControl::forget() {
    asked_N_ = 0;
    local_.reset();
}

double HandleControl::force_N() {
    // Saturated before the compensator: what is wished for beyond the limit cannot be had.
    const double limit_N = scale_.force_limit_N;
    double force_N = std::clamp(asked_N_, -limit_N, limit_N);
    if (port_) force_N = port_->force_N(force_N);
    if (settings_.compensator == Compensator::kLocalFixture) force_N += local_.force_N(position_hand_m_);
    if (two_port_) force_N = two_port_->force_N(force_N, energy_heard_J_);
    if (waves_) force_N = waves_->master.force_N(waves_->in_root_W);
    return std::clamp(force_N, -limit_N, limit_N);
}

}  // namespace thimble
