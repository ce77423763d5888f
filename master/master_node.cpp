#include "master/master_node.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "common/control/scaled_force.hpp"
#include "master/velocity_settings.hpp"

namespace thimble {

MasterSettings read_master_settings(const ConfigTable& table) {
    using std::chrono::microseconds;
    using std::chrono::seconds;
    MasterSettings s;
    s.position_scale = table.number("position_scale", s.position_scale, 0.01, 100);
    s.force_scale = table.number("force_scale", s.force_scale, 0, 100);
    s.force_limit_N = table.number("force_limit_N", s.force_limit_N, 0, 1000);
    s.sample_period = table.seconds("sample_period_s", s.sample_period, microseconds{100}, seconds{1});
    s.stale = read_stale_policy(table, s.stale, s.sample_period, seconds{1});
    s.oldest_force = table.seconds("oldest_force_s", s.oldest_force, Duration::zero(), seconds{3600});
    s.velocity = read_velocity_settings(table, s.sample_period, s.position_scale);
    return s;
}

MasterSettings read_master_settings(const ConfigFile& file) {
    MasterSettings s = read_master_settings(file.table("master"));
    s.guard = read_guard_settings(file.table("guard"));
    s.control = read_control_settings(file.table("control"));
    if (s.force_limit_N > s.guard.force_limit_N && file.table("master").has("force_limit_N")) {
        file.table("master").fail(
            "force_limit_N",
            fmt::format("is {:g}, but the guard before the handle lets {:g} N through: raise "
                        "[guard] force_limit_N as well, on purpose",
                        s.force_limit_N, s.guard.force_limit_N));
    }
    return s;
}

MasterNode::MasterNode(const MasterSettings& settings)
    : settings_(settings),
      estimator_(settings.velocity),
      control_(settings.control, {settings.position_scale, settings.force_scale, settings.force_limit_N,
                                  settings.sample_period}) {}

void MasterNode::start_trial(Modality modality, Duration network_delay) {
    control_.start(modality == Modality::kHF, network_delay);
    modality_ = modality;
    running_ = true;
    placed_ = false;
}

void MasterNode::end_trial() {
    running_ = false;
    control_.end();
}

NeedleCommand MasterNode::sample(SessionTime now, const HandleSample& handle) {
    const double position_needle_m = settings_.position_scale * handle.position_hand_m;
    if (!placed_) estimator_.reset(position_needle_m);
    placed_ = true;
    const auto estimate = estimator_.update(now, position_needle_m);
    if (control_.active()) control_.sample(now, handle);
    NeedleCommand command;
    command.position_needle_m = position_needle_m;
    command.velocity_needle_m_per_s = estimate.velocity_m_per_s;
    command.position_needle_estimate_m = estimate.position_estimate_m;
    command.position_hand_m = handle.position_hand_m;
    command.velocity_hand_m_per_s = estimate.velocity_m_per_s / settings_.position_scale;
    command.force_hand_N = handle.force_hand_N;
    return command;
}

double MasterNode::handle_force_N(const ForceFeedback& feedback) const {
    if (!running_ || modality_ != Modality::kHF || feedback.needle_held) return 0;
    // Feedback acts on the operator along +z; the handle's force counts positive when it pushes out, along
    // -z.
    const double force_hand_N = -settings_.force_scale * feedback.force_total_N;
    return ScaledForce{settings_.control.hand_share()}.hand_N(force_hand_N, settings_.force_limit_N);
}

}  // namespace thimble
