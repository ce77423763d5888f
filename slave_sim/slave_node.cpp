#include "slave_sim/slave_node.hpp"

#include <cassert>
#include <cmath>

namespace thimble {

namespace {

// False for NaN too.
bool within_reach(double position_m) { return std::abs(position_m) <= SlaveNode::kFarthestNeedleMetres; }

}  // namespace

SlaveNode::SlaveNode(const SlaveSettings& settings)
    : settings_(settings), scene_(settings.scene, settings.make_tissue), timer_(settings.contact_hold) {
    assert(scene_.surface() != nullptr && scene_.fixture() != nullptr);
}

void SlaveNode::start_trial(const SessionControl& order) {
    scene_.place_fixture(order.fixture_position_m, order.fixture_present);
    scene_.reset(scene_.needle());
    timer_.reset();
    scene_.clear_transitions();
    in_trial_ = true;
    needle_known_ = false;
    held_ = false;
    beep_due_ = false;
}

void SlaveNode::change_fixture(const SessionControl& order) {
    scene_.place_fixture(order.fixture_position_m, order.fixture_present);
}

void SlaveNode::end_trial() {
    in_trial_ = false;
    timer_.lose_contact();
    scene_.clear_transitions();
    beep_due_ = false;
}

ForceFeedback SlaveNode::on_needle(SessionTime sample_time, std::uint32_t sequence,
                                   const NeedleCommand& command) {
    scene_.clear_transitions();
    // Times before the clock's origin are refused, so that no difference of two can overflow.
    if (sample_time >= SessionTime{} && within_reach(command.position_needle_m) &&
        within_reach(command.position_needle_estimate_m)) {
        follow(sample_time, command);
    } else {
        ++refused_;
    }
    sequence_ = sequence;
    ForceFeedback feedback = answer();
    feedback.echo_time = sample_time;
    return feedback;
}

void SlaveNode::follow(SessionTime sample_time, const NeedleCommand& command) {
    if (needle_known_ && !held_ && sample_time <= sample_time_) return;
    const NeedleSample needle{command.position_needle_estimate_m, command.position_needle_m};
    if (!needle_known_) {
        scene_.reset(needle);
        scene_time_ = Duration::zero();
    } else {
        advance(sample_time, needle);
    }
    needle_known_ = true;
    held_ = false;
    sample_time_ = sample_time;
    const bool touching = in_trial_ && scene_.fixture()->touch(needle.position_reading_m).penetration_m > 0;
    beep_due_ = timer_.update(sample_time, touching) || beep_due_;
}

void SlaveNode::advance(SessionTime sample_time, const NeedleSample& needle) {
    Duration gap = sample_time - sample_time_;
    // After a hold the master may be another one, with another clock: then the length of the gap is unknown.
    if (gap <= Duration::zero()) gap = settings_.longest_step;
    if (gap > settings_.longest_step) {
        timer_.lose_contact();
        step(gap - settings_.longest_step, scene_.needle());
        gap = settings_.longest_step;
    }
    step(gap, needle);
}

void SlaveNode::step(Duration duration, const NeedleSample& needle) {
    scene_.step(to_seconds(scene_time_), to_seconds(duration), needle);
    scene_time_ += duration;
}

ForceFeedback SlaveNode::hold() {
    held_ = true;
    timer_.lose_contact();
    scene_.clear_transitions();
    return answer();
}

ForceFeedback SlaveNode::answer() const {
    const TissueState surface = scene_.surface()->state();
    ForceFeedback f;
    f.position_needle_m = scene_.needle().position_reading_m;
    f.position_surface_m = surface.position_surface_m;
    f.velocity_surface_m_per_s = surface.velocity_surface_m_per_s;
    f.position_proxy_m = scene_.fixture()->touch(f.position_needle_m).position_proxy_m;
    if (in_trial_ && needle_known_ && !held_) {
        f.force_tissue_N = scene_.force_tissue_N();
        f.force_fixture_N = scene_.force_fixture_N();
        f.force_total_N = f.force_tissue_N + f.force_fixture_N;
    }
    f.contact_time_s = to_seconds(timer_.time());
    f.echo_time = sample_time_;
    f.echo_sequence = sequence_;
    f.phase = surface.phase;
    f.fixture_present = scene_.fixture()->present();
    f.needle_held = held_;
    return f;
}

}  // namespace thimble
