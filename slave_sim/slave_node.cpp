#include "slave_sim/slave_node.hpp"

#include <cmath>

namespace thimble {

namespace {

// False for NaN too.
bool within_reach(double position_m) { return std::abs(position_m) <= SlaveNode::kFarthestNeedleMetres; }

}  // namespace

SlaveNode::SlaveNode(const SlaveSettings& settings)
    : settings_(settings),
      tissue_(settings.tissue),
      fixture_(settings.fixture),
      timer_(settings.contact_hold) {}

void SlaveNode::start_trial(const SessionControl& order) {
    fixture_.place(order.fixture_position_m, order.fixture_present);
    tissue_.reset(position_needle_m_);
    timer_.reset();
    events_.clear();
    in_trial_ = true;
    needle_known_ = false;
    held_ = false;
    beep_due_ = false;
}

void SlaveNode::change_fixture(const SessionControl& order) {
    fixture_.place(order.fixture_position_m, order.fixture_present);
}

void SlaveNode::end_trial() {
    in_trial_ = false;
    timer_.lose_contact();
    events_.clear();
    beep_due_ = false;
}

ForceFeedback SlaveNode::on_needle(SessionTime sample_time, std::uint32_t sequence,
                                   const NeedleCommand& command) {
    events_.clear();
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
    if (!needle_known_) {
        tissue_.reset(command.position_needle_estimate_m);
    } else {
        advance_tissue(sample_time, command.position_needle_estimate_m);
    }
    needle_known_ = true;
    held_ = false;
    sample_time_ = sample_time;
    position_needle_m_ = command.position_needle_m;
    const bool touching = in_trial_ && fixture_.touch(position_needle_m_).penetration_m > 0;
    beep_due_ = timer_.update(sample_time, touching) || beep_due_;
}

void SlaveNode::advance_tissue(SessionTime sample_time, double position_m) {
    Duration gap = sample_time - sample_time_;
    // After a hold the master may be another one, with another clock: then the length of the gap is unknown.
    if (gap <= Duration::zero()) gap = settings_.longest_step;
    if (gap > settings_.longest_step) {
        timer_.lose_contact();
        tissue_.step(to_seconds(gap - settings_.longest_step), tissue_.position_needle_m(), events_);
        gap = settings_.longest_step;
    }
    tissue_.step(to_seconds(gap), position_m, events_);
}

ForceFeedback SlaveNode::hold() {
    held_ = true;
    timer_.lose_contact();
    events_.clear();
    return answer();
}

ForceFeedback SlaveNode::answer() const {
    const TissueState tissue = tissue_.state();
    const FixtureContact fixture = fixture_.touch(position_needle_m_);
    ForceFeedback f;
    f.position_needle_m = position_needle_m_;
    f.position_surface_m = tissue.position_surface_m;
    f.velocity_surface_m_per_s = tissue.velocity_surface_m_per_s;
    f.position_proxy_m = fixture.position_proxy_m;
    if (in_trial_ && needle_known_ && !held_) {
        f.force_tissue_N = tissue.force_N;
        f.force_fixture_N = fixture.force_N;
        f.force_total_N = tissue.force_N + fixture.force_N;
    }
    f.contact_time_s = to_seconds(timer_.time());
    f.echo_time = sample_time_;
    f.echo_sequence = sequence_;
    f.phase = tissue.phase;
    f.fixture_present = fixture_.present();
    f.needle_held = held_;
    return f;
}

}  // namespace thimble
