// A part of a window: pixels of the framebuffer, from its top left corner.
#pragma once

namespace thimble {

struct Rect {
    double x = 0, y = 0, width = 0, height = 0;
    double right() const { return x + width; }
    double bottom() const { return y + height; }
};

}  // namespace thimble
