// Pictures of views, judged by their pixels.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "visual_node/views/view_layout.hpp"
#include "visual_node/window/image.hpp"

namespace thimble {

// Text and edges are blended with the colour behind them.
inline bool has_colour(const Image& image, int x, int y, Colour colour) {
    constexpr int kTolerance = 12;
    const Rgb pixel = image.at(x, y);
    for (std::size_t i = 0; i < pixel.size(); ++i)
        if (std::abs(pixel[i] - colour[i]) > kTolerance) return false;
    return true;
}

// Pixels of this colour in the rectangle.
inline int count_pixels(const Image& image, const Rect& rect, Colour colour) {
    int count = 0;
    for (int y = static_cast<int>(rect.y); y < static_cast<int>(std::floor(rect.bottom())); ++y)
        for (int x = static_cast<int>(rect.x); x < static_cast<int>(std::floor(rect.right())); ++x)
            count += has_colour(image, x, y, colour);
    return count;
}

// Pixels of the rectangle that differ by more than drivers' rounding.
inline int count_different(const Image& a, const Image& b, const Rect& rect) {
    int count = 0;
    for (int y = static_cast<int>(rect.y); y < static_cast<int>(rect.bottom()); ++y) {
        for (int x = static_cast<int>(rect.x); x < static_cast<int>(rect.right()); ++x) {
            const Rgb p = a.at(x, y), q = b.at(x, y);
            count += std::abs(p[0] - q[0]) + std::abs(p[1] - q[1]) + std::abs(p[2] - q[2]) > 24 ? 1 : 0;
        }
    }
    return count;
}

}  // namespace thimble
