// Which scene a frame shows: the newest, or, with smoothing, the past as far back as jitter reaches, interpolated between the
// samples around it. Samples are placed by the stamp the master gave them, not by when they came, so that a network's jitter
// does not show as jerks.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "visual_node/display.hpp"

namespace thimble {

class Playout {
  public:
    // `smoothing`: how far back; zero shows the newest scene as it is. At least as many scenes as come in that time are kept.
    explicit Playout(Duration smoothing, std::size_t capacity = 512);

    // A scene of which nothing has been seen yet. One with an older stamp than the last begins a new trial: what was is gone.
    void add(const Scene& scene);
    // What to show at `now`; nothing before the first scene. Interpolated are needle and surface; force, contact and
    // stamps are those of the older neighbour. Past the newest sample the newest stands still.
    std::optional<Scene> at(SessionTime now);
    // Of what at() gave last: from the arrival of its sample.
    Duration age(SessionTime now) const { return now - shown_arrival_; }

  private:
    const Scene& recent(std::size_t i) const { return ring_[(added_ - 1 - i) % ring_.size()]; }

    Duration smoothing_;
    std::vector<Scene> ring_;
    std::size_t added_ = 0;
    Duration quickest_{};  // arrival minus stamp, the least in this trial: where jitter begins
    SessionTime shown_arrival_{};
};

}  // namespace thimble
