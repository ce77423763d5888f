#include "common/control/controller_ends.hpp"

#include <algorithm>
#include <cmath>

#include "common/codec_fields.hpp"
#include "common/control/built_in_controllers.hpp"

namespace thimble {
namespace {

const thimble_controller& chosen(const ControlSettings& settings) {
    if (const thimble_controller* table = controller_of(settings)) return *table;
    throw Error(ExitCode::kUsage, "compensator {}: the session names none ([control] plugin)",
                kCompensatorNames.at(static_cast<std::size_t>(settings.compensator)));
}

}  // namespace

thimble_feedback feedback_of(const ForceFeedback& f, const HandleControlScale& scale, double age_s) {
    thimble_feedback feedback{};
    if (f.needle_held) return feedback;
    feedback.position_hand_m = f.position_needle_m / scale.position_scale;
    // Feedback acts on the operator along +z. The handle's force counts positive when it pushes out, along -z.
    feedback.force_total_hand_N = -scale.force_scale * f.force_total_N;
    feedback.force_fixture_hand_N = -scale.force_scale * f.force_fixture_N;
    feedback.force_tissue_hand_N = -scale.force_scale * f.force_tissue_N;
    feedback.age_s = age_s;
    feedback.known = 1;
    return feedback;
}

ControllerEnd::ControllerEnd(const ControlSettings& settings, const HandleControlScale& scale,
                             Create thimble_controller::*create, Destroy thimble_controller::*destroy)
    : table_(&chosen(settings)),
      calls_(settings.plugin.file, settings.clock),
      destroy_(table_->*destroy),
      sample_period_(scale.sample_period) {
    const std::vector<double> values = values_of(settings);
    const thimble_controller_settings given{to_seconds(scale.sample_period),
                                            scale.position_scale,
                                            scale.force_scale,
                                            scale.force_limit_N,
                                            static_cast<std::uint32_t>(values.size()),
                                            values.data(),
                                            settings.plugin.file.c_str()};
    self_ = calls_("create", table_->*create, &given);
    if (self_ == nullptr)
        throw Error(ExitCode::kUsage, "[control] {}: create() refuses its settings",
                    settings.plugin.file.empty() ? table_->name : settings.plugin.file.c_str());
    calls_.take_spent();
}

ControllerTally ControllerEnd::tally() const {
    ControllerTally tally = tally_;
    tally.longest_call = calls_.longest();
    return tally;
}

double ControllerEnd::finite_or(double value, double instead) {
    if (std::isfinite(value)) return value;
    ++tally_.not_numbers;
    return instead;
}

// A message beyond these limits is refused where it arrives.
WaveBurst ControllerEnd::sent(const thimble_packet& packet) {
    WaveBurst burst;
    for (std::size_t i = 0; i < burst.wave_root_W.size(); ++i)
        burst.wave_root_W[i] = std::clamp(finite_or(packet.value[i], 0), kWave_root_W.low, kWave_root_W.high);
    burst.sum_root_W_s = std::clamp(finite_or(packet.sum, 0), kWaveSum_root_W_s.low, kWaveSum_root_W_s.high);
    burst.energy_J = std::clamp(finite_or(packet.energy_J, 0), kWaveEnergy_J.low, kWaveEnergy_J.high);
    burst.number = packet.number;
    burst.count = std::min(packet.count, std::uint32_t{WaveBurst::kMost});
    return burst;
}

HandleEnd::HandleEnd(const ControlSettings& settings, const HandleControlScale& scale)
    : ControllerEnd(settings, scale, &thimble_controller::create, &thimble_controller::destroy) {}

void HandleEnd::start(Duration network_delay) {
    newest_ = {};
    sampled_before_ = false;
    call("start", table_->start, to_seconds(network_delay));
}

void HandleEnd::network_changed(Duration network_delay) {
    call("network_changed", table_->network_changed, to_seconds(network_delay));
}

WaveBurst HandleEnd::sample(SessionTime now, double position_hand_m, double velocity_hand_m_per_s,
                            double force_hand_N) {
    if (calls_.take_spent() > sample_period_) ++tally_.late_samples;
    ++tally_.samples;
    if (!sampled_before_) first_ = sampled_ = now;
    sampled_before_ = true;
    const thimble_handle handle{to_seconds(now - first_), to_seconds(now - sampled_), position_hand_m,
                                velocity_hand_m_per_s, force_hand_N};
    sampled_ = now;
    thimble_packet out{};
    call("sample", table_->sample, &handle, &out);
    return has(THIMBLE_BOTH_ENDS) ? sent(out) : WaveBurst{};
}

void HandleEnd::receive(const thimble_feedback& feedback) {
    newest_ = feedback;
    call("receive", table_->receive, &newest_);
}

void HandleEnd::receive(const WaveBurst& burst) {
    const thimble_packet packet = packet_of(burst);
    call("receive_packet", table_->receive_packet, &packet);
}

void HandleEnd::forget() {
    newest_ = {};
    call("forget", table_->forget);
}

double HandleEnd::force_N(Duration waited) {
    thimble_feedback aged = newest_;
    if (aged.known != 0) aged.age_s += to_seconds(waited);
    return finite_or(calls_("force", table_->force, self_, &aged), 0);
}

SlaveEnd::SlaveEnd(const ControlSettings& settings, const HandleControlScale& scale)
    : ControllerEnd(settings, scale, &thimble_controller::create_slave, &thimble_controller::destroy_slave) {}

void SlaveEnd::start() { call("start_slave", table_->start_slave); }

std::uint32_t SlaveEnd::receive(const NeedleWave& message, bool newer) {
    const NeedleCommand& c = message.command;
    const thimble_command command{c.position_hand_m, c.velocity_hand_m_per_s, c.force_hand_N,
                                  newer ? 1U : 0U};
    const thimble_packet packet = packet_of(message.waves);
    position_hand_m_ = c.position_hand_m;
    return std::min(calls_("receive_slave", table_->receive_slave, self_, &command, &packet), kMostAtOnce);
}

double SlaveEnd::step_hand_m(const thimble_surroundings& surroundings) {
    ++tally_.samples;
    return finite_or(calls_("step_slave", table_->step_slave, self_, &surroundings), position_hand_m_);
}

WaveBurst SlaveEnd::answer(const thimble_feedback& felt) {
    thimble_packet out{};
    call("answer_slave", table_->answer_slave, &felt, &out);
    return sent(out);
}

void SlaveEnd::hold() { call("hold_slave", table_->hold_slave); }

}  // namespace thimble
