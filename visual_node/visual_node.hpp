// The operator's view: the needle outside the tissue, the surface, in VF a bar for the resisting force. And the beep.
// A subject's scene never has the inserted part of the needle or the fixture. With VisualSettings::cut_away a scene has both.
#pragma once

#include <cstdint>
#include <optional>

#include "common/messages.hpp"
#include "common/time.hpp"
#include "visual_node/display.hpp"
#include "visual_node/visual_settings.hpp"

namespace thimble {

class VisualNode {
  public:
    explicit VisualNode(const VisualSettings& settings);

    // `trial` is the number in the header of `control`. Frames come at the refresh rate, with a phase that
    // study, experiment, subject and trial determine.
    void start_trial(SessionTime now, const SessionControl& control, std::uint32_t trial);
    // One more frame will come, with an empty bar.
    void end_trial(SessionTime now);
    // Of this trial, in order (the caller's sequence tracking sees to both). Needle and surface come from the one, bar and
    // fingers from the other. `answered`: its header's stamp.
    void on_picture(SessionTime now, const ForceFeedback& feedback, SessionTime answered = {});
    void on_force(SessionTime now, const ForceFeedback& feedback);

    // The next frame to draw; nothing before next_frame() and before the first picture of a trial.
    std::optional<Scene> frame(SessionTime now);
    // kNever unless a trial runs (or its last frame is due).
    SessionTime next_frame() const { return next_frame_; }

    // The percept of the eyes when `shown` has become visible; none if it was drawn in an earlier trial.
    std::optional<Percept> to_percept(const ShownScene& shown);
    // Sound takes no time: the latest percept once more, and from now to the end of the trial with the beep.
    Percept beep(SessionTime now);

  private:
    struct Sample {
        double position_needle_m = 0;
        double position_surface_m = 0;
        double force_resisting_N = 0;  // >= 0
        double force_drawing_N = 0;    // >= 0: into the tissue
        bool touching = false;
        SessionTime arrived = kNever, force_arrived = kNever;  // kNever: none in this trial
        double position_rest_m = 0;                            // the surface in the first one
        SessionTime hand_time{}, answered{};
        CutAway whole;
    };

    void schedule_after(SessionTime now);
    Duration silence(SessionTime now) const;
    double bar_N(SessionTime now) const;
    void add_what_pictures_need(SessionTime now, Scene& scene) const;

    VisualSettings settings_;
    SessionTime trial_start_{};
    SessionTime first_frame_{};
    SessionTime next_frame_ = kNever;
    std::int64_t frames_ = 0;  // periods from first_frame_ to next_frame_
    Sample newest_;
    Percept seen_;
    SessionTime seen_sample_time_{};
    std::uint32_t trial_ = 0;
    Modality modality_ = Modality::kHF;
    double position_fixture_m_ = 0;
    bool running_ = false;
};

}  // namespace thimble
