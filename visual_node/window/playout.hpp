// Which scene a frame shows: the newest, or, with smoothing, the past as far back as jitter reaches, interpolated between the
// samples around it. Samples are placed by the stamp the master gave them, not by when they came, so that a network's jitter
// does not show as jerks.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <optional>

#include <boost/circular_buffer.hpp>

#include "visual_node/display.hpp"

namespace thimble {

inline Scene between(const Scene& older, const Scene& newer, SessionTime stamp) {
    const double way = to_seconds(stamp - older.hand_time) / to_seconds(newer.hand_time - older.hand_time);
    Scene scene = older;
    scene.position_needle_m += way * (newer.position_needle_m - older.position_needle_m);
    scene.position_surface_m += way * (newer.position_surface_m - older.position_surface_m);
    // Rounding must not put the needle beneath the surface.
    scene.position_needle_m = std::min(scene.position_needle_m, scene.position_surface_m);
    if (scene.cut_away && newer.cut_away) {
        double& needle_m = scene.cut_away->position_needle_m;
        needle_m += way * (newer.cut_away->position_needle_m - needle_m);
    }
    return scene;
}

class Playout {
  public:
    // How long the least delay is remembered: for so long at least, and for twice as long at most.
    static constexpr Duration kRemembered = std::chrono::seconds{1};

    // `smoothing`: how far back; zero shows the newest scene as it is. At least as many scenes as come in that time are kept.
    explicit Playout(Duration smoothing, std::size_t capacity = 512)
        : smoothing_(smoothing), scenes_(capacity) {
        assert(smoothing >= Duration::zero() && capacity >= 2);
    }

    // A scene that was never seen. One of another trial, or with an older stamp than the last, begins anew: what was is gone.
    void add(const Scene& scene) {
        if (!scenes_.empty() && scene.trial != recent(0).trial) scenes_.clear();
        if (!scenes_.empty() && scene.hand_time == recent(0).hand_time) {
            scenes_.back() = scene;  // the same sample once more: its bar may have fallen
            return;
        }
        if (!scenes_.empty() && scene.hand_time < recent(0).hand_time) scenes_.clear();
        learn_delay(scene);
        scenes_.push_back(scene);
    }

    // The scene to show at `now`; nothing before the first scene. Interpolated are needle and surface; force, contact and
    // stamps are those of the older neighbour. Past the newest sample the newest stands still.
    std::optional<Scene> at(SessionTime now) {
        if (scenes_.empty()) return std::nullopt;
        const SessionTime stamp = now - smoothing_ - std::min(quickest_, quickest_before_);
        std::size_t older = 0;
        while (smoothing_ > Duration::zero() && older + 1 < scenes_.size() && recent(older).hand_time > stamp)
            ++older;
        const Scene& from = recent(older);
        if (older == 0 || from.hand_time > stamp) return from;
        return between(from, recent(older - 1), stamp);
    }

  private:
    // Forgets old minima of the delay: the network may have changed.
    void learn_delay(const Scene& scene) {
        const Duration took = scene.sample_time - scene.hand_time;
        if (scenes_.empty() || scene.hand_time - span_began_ >= kRemembered) {
            quickest_before_ = scenes_.empty() ? took : quickest_;
            quickest_ = took;
            span_began_ = scene.hand_time;
        }
        quickest_ = std::min(quickest_, took);
    }

    const Scene& recent(std::size_t i) const { return scenes_[scenes_.size() - 1 - i]; }

    Duration smoothing_;
    boost::circular_buffer<Scene> scenes_;
    // Arrival minus stamp, the least of this and the last span of kRemembered: where jitter begins.
    Duration quickest_{}, quickest_before_{};
    SessionTime span_began_{};
};

}  // namespace thimble
