// The fourth seam: something that shows a Scene. Scene holds only what the operator may see.
#pragma once

#include <optional>

#include "common/time.hpp"

namespace thimble {

struct Scene {
    double position_needle_m = 0;  // clipped to the surface once inside: the inserted part is never shown
    double position_surface_m = 0;
    double bar_N = 0;  // 0 unless the modality is VF
    double bar_full_scale_N = 12;
    bool touching = false;      // the needle touches or has entered the tissue
    SessionTime sample_time{};  // when the shown sample arrived at the display node
};

struct ShownScene {
    Scene scene;
    SessionTime shown_at{};  // when light left the screen
};

class Display {
  public:
    virtual ~Display() = default;
    Display() = default;
    Display(const Display&) = delete;
    Display& operator=(const Display&) = delete;

    // Hands over one frame.
    virtual void draw(SessionTime now, const Scene& scene) = 0;
    // The oldest frame that has become visible by `now` and was not returned before.
    virtual std::optional<ShownScene> shown(SessionTime now) = 0;
    // When the next frame becomes visible; kNever if none is on its way.
    virtual SessionTime next_shown() const = 0;
};

}  // namespace thimble
