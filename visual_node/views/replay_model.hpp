// The panel of a recorded trial without a screen: what is asked when something is pressed or the scrub bar is dragged, and where
// on that bar everything stands.
#pragma once

#include "visual_node/views/session_link.hpp"
#include "visual_node/views/view_layout.hpp"

namespace thimble {

class ReplayModel {
  public:
    // The link outlives the model. All below makes sense while its receiver has a replay().
    explicit ReplayModel(SessionLink& link) : link_(&link) {}

    void press(SessionTime now, Command command);
    void seek(SessionTime now, double time_s);  // taken to the nearest of the trial

    // The last order until the replay shows its effect, then the replay's state.
    double position_s() const;
    bool paused() const;
    double speed() const;
    const ReplayState& state() const;

  private:
    void play_or_pause(SessionTime now);
    void stop_and_step(SessionTime now, double step_s);
    bool asking(OrderKind kind) const { return link_->orders().progress(kind) == OrderProgress::kAsking; }

    SessionLink* link_;
};

// Between times of a trial and pixels of its scrub bar.
struct ScrubScale {
    Rect bar;
    double duration_s = 0;

    double x(double time_s) const;
    double time_s(double x) const;  // taken to the nearest of the trial
};

}  // namespace thimble
