// A display in memory: each frame becomes visible a fixed time after it was drawn (graphics card, cable, panel) and
// is kept for inspection.
#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <vector>

#include "visual_node/display.hpp"
#include "visual_node/visual_settings.hpp"

namespace thimble {

class RecordingDisplay final : public Display {
  public:
    // Each frame that a screen may have on its way, and some to look back at.
    explicit RecordingDisplay(const VisualSettings& s)
        : RecordingDisplay(
              s.pipeline, 256 + static_cast<std::size_t>(std::ceil(to_seconds(s.pipeline) * s.refresh_Hz))) {}
    // Remembers at most `capacity` frames, those on their way included.
    explicit RecordingDisplay(Duration pipeline, std::size_t capacity = 256)
        : pipeline_(pipeline), ring_(capacity) {
        assert(pipeline >= Duration::zero() && capacity > 0);
    }

    // With `capacity` frames on their way already, the new one is dropped and counted.
    void draw(SessionTime now, const Scene& scene) override {
        if (drawn_ - shown_ == ring_.size()) {
            ++dropped_;
            return;
        }
        at(drawn_) = {scene, now + pipeline_};
        if (shown_ == drawn_++) next_shown_ = now + pipeline_;
    }

    std::optional<ShownScene> shown(SessionTime now) override {
        if (now < next_shown_) return std::nullopt;
        const ShownScene& scene = at(shown_++);
        next_shown_ = shown_ == drawn_ ? kNever : at(shown_).shown_at;
        return scene;
    }

    SessionTime next_shown() const override { return next_shown_; }
    // No person is there.
    void turn_page(SessionTime /*now*/, const Page& /*page*/) override {}
    void beep(SessionTime /*now*/) override {}
    bool take_go_on() override { return false; }
    std::optional<GivenAnswer> take_answer() override { return std::nullopt; }
    bool take_stop() override { return false; }

    std::uint64_t shown_total() const { return shown_; }
    std::uint64_t dropped_total() const { return dropped_; }
    // How many shown frames are still remembered.
    std::size_t remembered() const {
        const std::uint64_t overwritten = drawn_ - std::min<std::uint64_t>(drawn_, ring_.size());
        return static_cast<std::size_t>(shown_ - std::min(shown_, overwritten));
    }

    // The i-th newest of them, 0 the newest.
    const ShownScene& recent(std::size_t i) const {
        assert(i < remembered());
        return at(shown_ - 1 - i);
    }

  private:
    ShownScene& at(std::uint64_t frame) { return ring_[frame % ring_.size()]; }
    const ShownScene& at(std::uint64_t frame) const { return ring_[frame % ring_.size()]; }

    Duration pipeline_;
    std::vector<ShownScene> ring_;
    std::uint64_t drawn_ = 0;  // frames [shown_, drawn_) are on their way, those before are history
    std::uint64_t shown_ = 0;
    std::uint64_t dropped_ = 0;
    SessionTime next_shown_ = kNever;  // asked for on every tick: kept, not looked up
};

}  // namespace thimble
