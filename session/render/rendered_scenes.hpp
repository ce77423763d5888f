// A recorded trial as the scenes that the subject's screen showed. The forces arrive one network delay after they were
// recorded, the picture at once or with them. VisualNode decides which part of it is seen.
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
    // Calls use(when, feedback) for each sample from the `next`-th on that has arrived by `time_s`.
    template <class Arrival, class Use>
    void arrive(double time_s, std::size_t& next, const Arrival& arrival_s, const Use& use);
    double force_arrival_s(const TrajectorySample& sample) const;

    const RecordedTrial* trial_;
    bool picture_delayed_;
    VisualNode node_;
    std::size_t next_force_ = 0, next_picture_ = 0;
    double newest_s_ =
        0;  // when the newest force arrived: after a shorter delay the others wait for those in flight
    std::optional<Scene> newest_;
};

}  // namespace thimble
