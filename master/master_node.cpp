#include "master/master_node.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace thimble {

namespace {

constexpr double kNominalEncoderStep_hand_m = 1e-5;

VelocitySettings read_velocity(const ConfigTable& table, const MasterSettings& master) {
    using std::chrono::milliseconds;
    using std::chrono::seconds;
    VelocitySettings v;
    v.sample_period = master.sample_period;
    v.method =
        static_cast<VelocityMethod>(table.choice("velocity_estimator", static_cast<std::size_t>(v.method),
                                                 {kVelocityMethodNames.begin(), kVelocityMethodNames.end()}));
    v.time_constant = table.seconds("velocity_time_constant_s", v.time_constant, Duration{0}, seconds{1});
    v.window = table.seconds("velocity_window_s", std::max(v.window, master.sample_period),
                             master.sample_period, seconds{1});
    if (v.window > (SampleWindow::kCapacity - 1) * master.sample_period) {
        table.fail("velocity_window_s",
                   fmt::format("at most {} samples of sample_period_s fit into the window",
                               SampleWindow::kCapacity - 1));
    }
    v.fit = table.choice("velocity_foaw_fit", 0, {"best", "end"}) == 0 ? FoawFit::kBest : FoawFit::kEnd;
    v.quantum_m = table.number("velocity_quantum_needle_m",
                               master.position_scale * kNominalEncoderStep_hand_m, 1e-9, 0.1);
    v.acceleration_noise_m2_per_s3 =
        table.number("velocity_process_noise_m2_per_s3", v.acceleration_noise_m2_per_s3, 1e-9, 1e6);
    return v;
}

}  // namespace

MasterSettings read_master_settings(const ConfigTable& table) {
    using std::chrono::microseconds;
    using std::chrono::seconds;
    MasterSettings s;
    s.position_scale = table.number("position_scale", s.position_scale, 0.01, 100);
    s.force_scale = table.number("force_scale", s.force_scale, 0, 100);
    s.force_limit_N = table.number("force_limit_N", s.force_limit_N, 0, 1000);
    s.sample_period = table.seconds("sample_period_s", s.sample_period, microseconds{100}, seconds{1});
    s.stale_after = table.seconds("stale_after_s", s.stale_after, s.sample_period, seconds{1});
    s.velocity = read_velocity(table, s);
    return s;
}

MasterNode::MasterNode(const MasterSettings& settings) : settings_(settings), estimator_(settings.velocity) {}

void MasterNode::start_trial(Modality modality) {
    modality_ = modality;
    running_ = true;
    placed_ = false;
}

void MasterNode::end_trial() { running_ = false; }

NeedleCommand MasterNode::sample(SessionTime now, const HandleSample& handle) {
    const double position_needle_m = settings_.position_scale * handle.position_hand_m;
    if (!placed_) estimator_.reset(position_needle_m);
    placed_ = true;
    const auto estimate = estimator_.update(now, position_needle_m);
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
    return std::clamp(force_hand_N, -settings_.force_limit_N, settings_.force_limit_N);
}

}  // namespace thimble
