#include "visual_node/visual_node.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/random.hpp"

namespace thimble {

VisualNode::VisualNode(const VisualSettings& settings) : settings_(settings) {
    assert(settings.refresh_Hz > 0 && settings.bar_full_scale_N > 0 && settings.bar_resolution > 0);
}

void VisualNode::start_trial(SessionTime now, const SessionControl& control, std::uint32_t trial) {
    RandomStream phase({control.study_seed, control.experiment, control.subject, trial, Purpose::kFrames});
    first_frame_ = now + from_seconds(phase.uniform() / settings_.refresh_Hz);
    next_frame_ = first_frame_;
    frames_ = 0;
    trial_start_ = now;
    newest_ = {};
    seen_ = {};
    seen_sample_time_ = now;
    trial_ = trial;
    modality_ = control.modality;
    position_fixture_m_ = control.fixture_position_m;
    running_ = true;
}

void VisualNode::end_trial(SessionTime) { running_ = false; }

void VisualNode::on_picture(SessionTime now, const ForceFeedback& feedback, SessionTime answered) {
    if (!running_) return;
    if (newest_.arrived == kNever) newest_.position_rest_m = feedback.position_surface_m;
    newest_.position_needle_m = feedback.position_needle_m;
    newest_.position_surface_m = feedback.position_surface_m;
    newest_.touching =
        feedback.phase != TissuePhase::kFree || feedback.position_needle_m >= feedback.position_surface_m;
    newest_.arrived = now;
    newest_.hand_time = feedback.echo_time;
    newest_.answered = answered;
    if (!settings_.cut_away) return;
    newest_.whole = {feedback.position_needle_m,
                     position_fixture_m_,
                     feedback.force_tissue_N,
                     feedback.force_fixture_N,
                     std::nullopt,
                     feedback.phase,
                     modality_,
                     feedback.fixture_present};
}

void VisualNode::on_force(SessionTime now, const ForceFeedback& feedback) {
    if (!running_) return;
    // Written so that a NaN is no force.
    newest_.force_resisting_N = feedback.force_total_N < 0 ? -feedback.force_total_N : 0.0;
    newest_.force_drawing_N = feedback.force_total_N > 0 ? feedback.force_total_N : 0.0;
    newest_.force_arrived = now;
}

// Silence of the force. The first force may take the network's whole delay.
Duration VisualNode::silence(SessionTime now) const {
    return newest_.force_arrived == kNever ? Duration{} : now - newest_.force_arrived;
}

std::optional<Scene> VisualNode::frame(SessionTime now) {
    if (now < next_frame_) return std::nullopt;
    schedule_after(now);
    if (newest_.arrived == kNever) return std::nullopt;
    Scene scene;
    scene.position_surface_m = newest_.position_surface_m;
    scene.position_needle_m = std::min(newest_.position_needle_m, newest_.position_surface_m);
    scene.bar_N = bar_N(now);
    scene.bar_full_scale_N = settings_.bar_full_scale_N;
    scene.touching = newest_.touching;
    scene.sample_time = newest_.arrived;
    add_what_pictures_need(now, scene);
    return scene;
}

void VisualNode::add_what_pictures_need(SessionTime now, Scene& scene) const {
    const double share = running_ ? settings_.stale.share(silence(now)) : 0;
    scene.stale = running_ && settings_.stale.stale(std::max(silence(now), now - newest_.arrived));
    scene.position_surface_rest_m = newest_.position_rest_m;
    scene.bar_shown = modality_ == Modality::kVF;
    scene.fingertip_shown =
        settings_.fingertip && (modality_ == Modality::kCF || modality_ == Modality::kCCF);
    scene.fingertip_N = scene.fingertip_shown ? share * newest_.force_resisting_N : 0;
    scene.thumb_N = scene.fingertip_shown ? share * newest_.force_drawing_N : 0;
    scene.hand_time = newest_.hand_time;
    scene.answer_time = newest_.answered;
    scene.trial = trial_;
    if (settings_.cut_away) scene.cut_away = newest_.whole;
}

// Counted from the first frame: 1/60 s is no whole number of nanoseconds, and the error must not add up.
void VisualNode::schedule_after(SessionTime now) {
    if (!running_) {
        next_frame_ = kNever;
        return;
    }
    do {
        ++frames_;
        next_frame_ = first_frame_ + from_seconds(static_cast<double>(frames_) / settings_.refresh_Hz);
    } while (next_frame_ <= now);
}

double VisualNode::bar_N(SessionTime now) const {
    if (modality_ != Modality::kVF || !running_) return 0;
    const double share = settings_.stale.share(silence(now));
    const double full_N = settings_.bar_full_scale_N;
    const double pixels = static_cast<double>(settings_.bar_resolution);
    return std::floor(std::min(share * newest_.force_resisting_N, full_N) / full_N * pixels) * full_N /
           pixels;
}

std::optional<Percept> VisualNode::to_percept(const ShownScene& shown) {
    if (shown.scene.sample_time < trial_start_) return std::nullopt;
    seen_.position_needle_shown_m = shown.scene.position_needle_m;
    seen_.position_surface_shown_m = shown.scene.position_surface_m;
    seen_.bar_N = shown.scene.bar_N;
    seen_.touching_shown = shown.scene.touching;
    seen_sample_time_ = shown.scene.sample_time;
    seen_.sample_age_s = to_seconds(shown.shown_at - seen_sample_time_);
    return seen_;
}

Percept VisualNode::beep(SessionTime now) {
    seen_.beep = true;
    seen_.sample_age_s = to_seconds(now - seen_sample_time_);
    return seen_;
}

}  // namespace thimble
