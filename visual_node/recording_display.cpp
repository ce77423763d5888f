#include "visual_node/recording_display.hpp"

#include <algorithm>
#include <cassert>

namespace thimble {

RecordingDisplay::RecordingDisplay(Duration pipeline, std::size_t capacity)
    : pipeline_(pipeline), ring_(capacity) {
    assert(pipeline >= Duration::zero() && capacity > 0);
}

void RecordingDisplay::draw(SessionTime now, const Scene& scene) {
    if (drawn_ - shown_ == ring_.size()) {
        ++dropped_;
        return;
    }
    at(drawn_) = {scene, now + pipeline_};
    if (shown_ == drawn_++) next_shown_ = now + pipeline_;
}

std::optional<ShownScene> RecordingDisplay::shown(SessionTime now) {
    if (now < next_shown_) return std::nullopt;
    const ShownScene& scene = at(shown_++);
    next_shown_ = shown_ == drawn_ ? kNever : at(shown_).shown_at;
    return scene;
}

std::size_t RecordingDisplay::remembered() const {
    const std::uint64_t overwritten = drawn_ - std::min<std::uint64_t>(drawn_, ring_.size());
    return static_cast<std::size_t>(shown_ - std::min(shown_, overwritten));
}

const ShownScene& RecordingDisplay::recent(std::size_t i) const {
    assert(i < remembered());
    return at(shown_ - 1 - i);
}

}  // namespace thimble
