#include "visual_node/window/playout.hpp"

#include <algorithm>
#include <cassert>

namespace thimble {
namespace {

Scene between(const Scene& older, const Scene& newer, SessionTime stamp) {
    const double way = to_seconds(stamp - older.hand_time) / to_seconds(newer.hand_time - older.hand_time);
    Scene scene = older;
    scene.position_needle_m += way * (newer.position_needle_m - older.position_needle_m);
    scene.position_surface_m += way * (newer.position_surface_m - older.position_surface_m);
    // Rounding must not put the needle beneath the surface.
    scene.position_needle_m = std::min(scene.position_needle_m, scene.position_surface_m);
    return scene;
}

}  // namespace

Playout::Playout(Duration smoothing, std::size_t capacity) : smoothing_(smoothing), scenes_(capacity) {
    assert(smoothing >= Duration::zero() && capacity >= 2);
}

void Playout::add(const Scene& scene) {
    if (!scenes_.empty() && scene.trial != recent(0).trial) scenes_.clear();
    if (!scenes_.empty() && scene.hand_time == recent(0).hand_time) {
        scenes_.back() = scene;  // the same sample once more: its bar may have fallen
        return;
    }
    if (!scenes_.empty() && scene.hand_time < recent(0).hand_time) scenes_.clear();
    learn_delay(scene);
    scenes_.push_back(scene);
}

// A delay that was once less says nothing about the network of now.
void Playout::learn_delay(const Scene& scene) {
    const Duration took = scene.sample_time - scene.hand_time;
    if (scenes_.empty() || scene.hand_time - span_began_ >= kRemembered) {
        quickest_before_ = scenes_.empty() ? took : quickest_;
        quickest_ = took;
        span_began_ = scene.hand_time;
    }
    quickest_ = std::min(quickest_, took);
}

std::optional<Scene> Playout::at(SessionTime now) {
    if (scenes_.empty()) return std::nullopt;
    const SessionTime stamp = now - smoothing_ - std::min(quickest_, quickest_before_);
    std::size_t older = 0;
    while (smoothing_ > Duration::zero() && older + 1 < scenes_.size() && recent(older).hand_time > stamp)
        ++older;
    const Scene& from = recent(older);
    shown_arrival_ = from.sample_time;
    if (older == 0 || from.hand_time > stamp) return from;
    return between(from, recent(older - 1), stamp);
}

}  // namespace thimble
