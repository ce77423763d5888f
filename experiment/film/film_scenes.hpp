// A recorded trial as the scenes that the subject's screen showed: the samples arrive one network delay after they were
// recorded, and VisualNode says what may be seen of them.
#pragma once

#include <span>

#include "experiment/trial_record.hpp"
#include "visual_node/visual_node.hpp"

namespace thimble {

class FilmScenes {
  public:
    // `samples` in order of time, not empty; they outlive this. Delay and modality are those of `conditions`.
    FilmScenes(std::span<const TrajectorySample> samples, const TrialConditions& conditions,
               VisualSettings settings);

    // What the screen shows `time_s` after the start of the trial; nothing before the first sample has arrived. Times
    // must not fall.
    std::optional<Scene> at(double time_s);
    // Until the last sample has arrived.
    double duration_s() const { return samples_.back().time_s + delay_s_; }

  private:
    std::span<const TrajectorySample> samples_;
    double delay_s_;
    VisualNode node_;
    std::size_t next_ = 0;
    std::optional<Scene> newest_;
};

}  // namespace thimble
