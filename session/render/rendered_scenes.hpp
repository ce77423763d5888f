// A recorded trial as the scenes that the subject's screen showed: the samples arrive one network delay after they were
// recorded, and VisualNode says what may be seen of them.
#pragma once

#include "session/play/recorded_trial.hpp"
#include "visual_node/visual_node.hpp"

namespace thimble {

class RenderedScenes {
  public:
    // `trial` has samples, in order of time, and outlives this.
    RenderedScenes(const RecordedTrial& trial, VisualSettings settings);

    // The scene on the screen `time_s` after the start of the trial; nothing before the first sample has arrived. Times
    // must not fall.
    std::optional<Scene> at(double time_s);
    // Until the last sample has arrived.
    double duration_s() const;

  private:
    double arrival_s(const TrajectorySample& sample) const;

    const RecordedTrial* trial_;
    VisualNode node_;
    std::size_t next_ = 0;
    double newest_s_ =
        0;  // when the newest sample arrived: after a shorter delay the others wait for those in flight
    std::optional<Scene> newest_;
};

}  // namespace thimble
