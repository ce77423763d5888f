// The fourth seam: something that shows a Scene. Scene holds only what the operator may see.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include <boost/core/noncopyable.hpp>

#include "common/messages.hpp"
#include "common/shared_values.hpp"
#include "common/time.hpp"

namespace thimble {

// For the cut-away view alone; a subject of a study must not see it.
struct CutAway {
    double position_needle_m = 0;  // with its inserted part
    double position_fixture_m = 0;
    double force_tissue_N = 0;  // on the operator: negative resists insertion
    double force_fixture_N = 0;
    std::optional<double>
        position_hand_m{};  // where the hand wants the needle; not known of a recorded trial
    TissuePhase phase = TissuePhase::kFree;
    Modality modality = Modality::kHF;
    bool fixture_present = true;
};

struct Scene {
    double position_needle_m = 0;  // clipped to the surface once inside: the inserted part is never shown
    double position_surface_m = 0;
    double bar_N = 0;  // 0 unless the modality is VF
    double bar_full_scale_N = kBarFullScale_N;
    bool touching = false;      // the needle touches or has entered the tissue
    SessionTime sample_time{};  // when the shown sample arrived at the display node

    // Values for the picture alone, which percepts do not use.
    double position_surface_rest_m =
        0;  // as in the first sample of the trial: what a dimple is drawn against
    double fingertip_N =
        0;  // [visual].fingertip, CF and CCF: what a fingertip graphic shows in place of a device
    double thumb_N = 0;      // the same of the thumb, which feels what draws the needle in
    bool bar_shown = false;  // VF: the bar's frame and scale, also while the force is 0
    bool fingertip_shown = false;
    bool stale = false;         // nothing has come for a while: what is shown may be wrong by now
    SessionTime hand_time{};    // when the handle was read, on the master's clock
    SessionTime answer_time{};  // when slave_sim answered, on its clock
    std::uint32_t trial = 0;
    std::optional<CutAway> cut_away{};

    // A view of the inside shows the whole force (negative resists insertion): on both fingers, and in VF as the bar.
    void set_cut_away(const CutAway& inside, double force_total_N) {
        fingertip_N = std::max(0.0, -force_total_N);
        thumb_N = std::max(0.0, force_total_N);
        bar_shown = inside.modality == Modality::kVF;
        bar_N = bar_shown ? fingertip_N : 0;
        cut_away = inside;
    }
};

// The subject's answer to question number `question` of the page set.
struct GivenAnswer {
    std::uint32_t question = 0;
    double value = 0;
};

struct ShownScene {
    Scene scene;
    SessionTime shown_at{};  // when light left the screen
};

// All calls are pure virtual: a wrapper that forgot one would hide it.
class Display : boost::noncopyable {
  public:
    virtual ~Display() = default;

    // Hands over one frame.
    virtual void draw(SessionTime now, const Scene& scene) = 0;
    // The oldest frame that has become visible by `now` and was not returned before.
    virtual std::optional<ShownScene> shown(SessionTime now) = 0;
    // When the next frame becomes visible; kNever if none is on its way.
    virtual SessionTime next_shown() const = 0;
    // The page between trials; kNone: no page.
    virtual void turn_page(SessionTime now, const Page& page) = 0;
    virtual void beep(SessionTime now) = 0;
    // Whether the subject has asked to go on since the last call.
    virtual bool take_go_on() = 0;
    // The subject's answer to a question, given since the last call.
    virtual std::optional<GivenAnswer> take_answer() = 0;
    // Whether a person at the screen has pressed stop since the last call.
    virtual bool take_stop() = 0;
};

}  // namespace thimble
