// Triangles with a colour at each corner, in pixels from the top left corner: all that the cut-away view is made of. Pure, so that a
// test, a browser or another painter can draw the same.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/colours.hpp"

namespace thimble {

// A part of a window: pixels of the framebuffer, from its top left corner.
struct Rect {
    double x = 0, y = 0, width = 0, height = 0;
    double right() const { return x + width; }
    double bottom() const { return y + height; }
};

struct Ink {
    float r = 0, g = 0, b = 0, a = 1;  // 0 to 1, sRGB
};
Ink ink(const Colour& colour, double opacity = 1);
// `share` 0: `from`, 1: `to`.
Ink mix(const Ink& from, const Ink& to, double share);
// The same colour under more or less light; 1: as it is.
Ink lit(const Ink& colour, double light);
Ink faded(const Ink& colour, double opacity);

struct Spot {
    double x = 0, y = 0;
};

class Mesh {
  public:
    struct Vertex {
        float x = 0, y = 0;
        std::array<std::uint8_t, 4> rgba{};
    };

    void clear();
    // Corners in order around the quad; what comes later covers what came earlier.
    void quad(const std::array<Spot, 4>& corners, const std::array<Ink, 4>& inks);
    void quad(const std::array<Spot, 4>& corners, const Ink& colour);
    // From `top` to `bottom`, or, for gradients across, from left to right.
    void box_down(const Spot& from, const Spot& to, const Ink& top, const Ink& bottom);
    void box_across(const Spot& from, const Spot& to, const Ink& left, const Ink& right);
    // An ellipse whose colour runs from its middle to its rim: with a clear rim, a soft shadow.
    void disc(const Spot& middle, const Spot& radii, const Ink& inner, const Ink& rim);
    // Convex, with an edge that is soft by a pixel.
    void polygon(std::span<const Spot> corners, const Ink& colour);
    // A line with soft edges.
    void stroke(const Spot& from, const Spot& to, double width, const Ink& colour);
    void path(std::span<const Spot> points, double width, const Ink& colour);
    void ring(const Spot& middle, double radius, double width, const Ink& colour);

    const std::vector<Vertex>& vertices() const { return vertices_; }
    const std::vector<std::uint32_t>& indices() const { return indices_; }

  private:
    std::uint32_t add(const Spot& spot, const Ink& colour);
    void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);

    std::vector<Vertex> vertices_;
    std::vector<std::uint32_t> indices_;
};

}  // namespace thimble
