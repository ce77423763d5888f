// Which scene a frame shows: the newest, or, with smoothing, the past as far back as jitter reaches, interpolated between the
// samples around it. Samples are placed by the stamp the master gave them, not by when they came, so that a network's jitter
// does not show as jerks.
#pragma once

#include <cstddef>
#include <optional>

#include <boost/circular_buffer.hpp>

#include "visual_node/display.hpp"

namespace thimble {

class Playout {
  public:
    // How long the least delay is remembered: for so long at least, and for twice as long at most.
    static constexpr Duration kRemembered = std::chrono::seconds{1};

    // `smoothing`: how far back; zero shows the newest scene as it is. At least as many scenes as come in that time are kept.
    explicit Playout(Duration smoothing, std::size_t capacity = 512);

    // A scene that was never seen. One of another trial, or with an older stamp than the last, begins anew: what was is gone.
    void add(const Scene& scene);
    // The scene to show at `now`; nothing before the first scene. Interpolated are needle and surface; force, contact and
    // stamps are those of the older neighbour. Past the newest sample the newest stands still.
    std::optional<Scene> at(SessionTime now);
    // The age of the scene that at() gave last, since the arrival of its sample.
    Duration age(SessionTime now) const { return now - shown_arrival_; }

  private:
    void learn_delay(const Scene& scene);
    const Scene& recent(std::size_t i) const { return scenes_[scenes_.size() - 1 - i]; }

    Duration smoothing_;
    boost::circular_buffer<Scene> scenes_;
    // Arrival minus stamp, the least of this and the last span of kRemembered: where jitter begins.
    Duration quickest_{}, quickest_before_{};
    SessionTime span_began_{};
    SessionTime shown_arrival_{};
};

}  // namespace thimble
