#include "slave_sim/slave_node.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/control/built_in_controllers.hpp"

namespace thimble {

namespace {

// A stamp may be years ahead (a clock that steps, a flipped bit), and some solvers take every step until then.
constexpr Duration kLongestRest = std::chrono::seconds{100};

// A robot's tissue is real. The simulated one follows a needle so far out that it stays at rest.
constexpr double kOutOfTissue_m = 5;

// False for NaN too.
bool within_reach(double position_m) { return std::abs(position_m) <= SlaveNode::kFarthestNeedleMetres; }

}  // namespace

SlaveNode::SlaveNode(const SlaveSettings& settings)
    : settings_(settings), scene_(settings.scene, settings.make_tissue), timer_(settings.contact_hold) {
    if (has_two_ends(settings.control.control))
        end_.emplace(settings.control.control, settings.control.scale);
    assert(scene_.surface() != nullptr && scene_.fixture() != nullptr);
}

void SlaveNode::start_trial(const SessionControl& order) {
    scene_.place_fixture(order.fixture_position_m, order.fixture_present);
    scene_.reset(scene_.needle());
    timer_.reset();
    scene_.clear_transitions();
    waves_ = end_ && order.modality == Modality::kHF;
    if (waves_) end_->start();
    burst_ = {};
    force_robot_N_.reset();
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

ForceFeedback SlaveNode::on_wave(SessionTime sample_time, std::uint32_t sequence, const NeedleWave& message) {
    scene_.clear_transitions();
    const Duration period = settings_.control.scale.sample_period;
    const bool first = !needle_known_;
    const bool newer = first || held_ || sample_time > sample_time_;
    const std::uint32_t samples = end_->receive(message, newer);
    if (sample_time < SessionTime{} + samples * period || !within_reach(message.command.position_hand_m)) {
        ++refused_;
    } else {
        if (first)
            wave_estimator_.reset(settings_.control.scale.position_scale * message.command.position_hand_m);
        for (std::uint32_t left = samples; left-- > 0;) {
            const SessionTime then = sample_time - left * period;
            follow(then, wave_step(then));
        }
    }
    sequence_ = sequence;
    ForceFeedback feedback = answer();
    feedback.echo_time = sample_time;
    burst_ = end_->answer(feedback_of(feedback, settings_.control.scale, 0));
    return feedback;
}

ForceFeedback SlaveNode::on_robot(SessionTime sample_time, std::uint32_t sequence, double position_m,
                                  double force_N) {
    if (!needle_known_) wave_estimator_.reset(position_m);
    force_robot_N_ = force_N;
    NeedleCommand measured;
    measured.position_needle_m = position_m;
    measured.position_needle_estimate_m =
        wave_estimator_.update(sample_time, position_m).position_estimate_m - kOutOfTissue_m;
    return on_needle(sample_time, sequence, measured);
}

// Other elements act with the force of the previous sample. The fixture is stiff, so its force is solved for.
NeedleCommand SlaveNode::wave_step(SessionTime sample_time) {
    const HandleControlScale& scale = settings_.control.scale;
    const ForbiddenRegion& fixture = *scene_.fixture();
    double other_N = 0;
    if (!held_ && needle_known_) {
        const double needle_m = scene_.needle().position_reading_m;
        other_N = scene_.force_tissue_N() + scene_.force_fixture_N() - fixture.touch(needle_m).force_N;
    }
    const double stiffness_N_per_m = fixture.present() ? fixture.stiffness_N_per_m() : 0;
    const double hand_m = end_->step_hand_m({fixture.position_m() / scale.position_scale,
                                             scale.force_scale * scale.position_scale * stiffness_N_per_m,
                                             -scale.force_scale * other_N});
    NeedleCommand command;
    // A plug-in may return any number.
    command.position_needle_m =
        std::clamp(scale.position_scale * hand_m, -kFarthestNeedleMetres, kFarthestNeedleMetres);
    command.position_needle_estimate_m =
        wave_estimator_.update(sample_time, command.position_needle_m).position_estimate_m;
    return command;
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

// Called in one place, for each sample: the compiler makes one function of both.
inline void SlaveNode::advance(SessionTime sample_time, const NeedleSample& needle) {
    Duration gap = sample_time - sample_time_;
    // After a hold the master may be another one, with another clock: then the length of the gap is unknown.
    if (gap <= Duration::zero()) gap = settings_.longest_step;
    gap = std::min(gap, settings_.longest_step + kLongestRest);
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
    if (waves_) end_->hold();
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
        f.force_tissue_N = force_robot_N_.value_or(scene_.force_tissue_N());
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
