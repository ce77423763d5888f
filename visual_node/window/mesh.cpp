#include "visual_node/window/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace thimble {
namespace {

constexpr int kCorners = 40;  // of a circle

std::uint8_t byte(float share) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(share, 0.0F, 1.0F)));
}

Spot on_ellipse(const Spot& middle, const Spot& radii, int corner) {
    const double angle = 2 * std::numbers::pi * corner / kCorners;
    return {middle.x + radii.x * std::cos(angle), middle.y + radii.y * std::sin(angle)};
}

// Away from the line `from`, `to` to its left, of length 1; zero where the two are one.
Spot normal(const Spot& from, const Spot& to) {
    const double x = to.x - from.x, y = to.y - from.y, length = std::hypot(x, y);
    if (!(length > 0)) return {};
    return {y / length, -x / length};
}

}  // namespace

Ink ink(const Colour& colour, double opacity) {
    const auto share = [&](std::size_t i) { return static_cast<float>(colour[i]) / 255; };
    return {share(0), share(1), share(2), static_cast<float>(opacity)};
}

Ink mix(const Ink& from, const Ink& to, double share) {
    const auto t = static_cast<float>(std::clamp(share, 0.0, 1.0));
    return {std::lerp(from.r, to.r, t), std::lerp(from.g, to.g, t), std::lerp(from.b, to.b, t),
            std::lerp(from.a, to.a, t)};
}

Ink lit(const Ink& colour, double light) {
    const auto l = static_cast<float>(light);
    return {colour.r * l, colour.g * l, colour.b * l, colour.a};
}

Ink faded(const Ink& colour, double opacity) {
    return {colour.r, colour.g, colour.b, colour.a * static_cast<float>(opacity)};
}

void Mesh::clear() {
    vertices_.clear();
    indices_.clear();
}

std::uint32_t Mesh::add(const Spot& spot, const Ink& colour) {
    vertices_.push_back({static_cast<float>(spot.x),
                         static_cast<float>(spot.y),
                         {byte(colour.r), byte(colour.g), byte(colour.b), byte(colour.a)}});
    return static_cast<std::uint32_t>(vertices_.size() - 1);
}

void Mesh::triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    indices_.insert(indices_.end(), {a, b, c});
}

void Mesh::quad(const std::array<Spot, 4>& corners, const std::array<Ink, 4>& inks) {
    const std::uint32_t first = add(corners[0], inks[0]);
    for (std::size_t i = 1; i < 4; ++i) add(corners[i], inks[i]);
    triangle(first, first + 1, first + 2);
    triangle(first, first + 2, first + 3);
}

void Mesh::quad(const std::array<Spot, 4>& corners, const Ink& colour) {
    quad(corners, {colour, colour, colour, colour});
}

void Mesh::box_down(const Spot& from, const Spot& to, const Ink& top, const Ink& bottom) {
    quad({from, {to.x, from.y}, to, {from.x, to.y}}, {top, top, bottom, bottom});
}

void Mesh::box_across(const Spot& from, const Spot& to, const Ink& left, const Ink& right) {
    quad({from, {to.x, from.y}, to, {from.x, to.y}}, {left, right, right, left});
}

void Mesh::disc(const Spot& middle, const Spot& radii, const Ink& inner, const Ink& rim) {
    const std::uint32_t centre = add(middle, inner);
    for (int i = 0; i < kCorners; ++i) add(on_ellipse(middle, radii, i), rim);
    for (std::uint32_t i = 0; i < kCorners; ++i)
        triangle(centre, centre + 1 + i, centre + 1 + (i + 1) % kCorners);
}

void Mesh::polygon(std::span<const Spot> corners, const Ink& colour) {
    const std::size_t count = corners.size();
    double area = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Spot &a = corners[i], &b = corners[(i + 1) % count];
        area += a.x * b.y - b.x * a.y;
    }
    const double outwards = area > 0 ? 0.5 : -0.5;
    const auto first = static_cast<std::uint32_t>(vertices_.size());
    for (std::size_t i = 0; i < count; ++i) {
        const Spot& at = corners[i];
        const Spot before = normal(corners[(i + count - 1) % count], at),
                   after = normal(at, corners[(i + 1) % count]);
        Spot away{before.x + after.x, before.y + after.y};
        const double square = std::max(away.x * away.x + away.y * away.y, 0.5);
        away = {2 * outwards * away.x / square, 2 * outwards * away.y / square};
        add({at.x - away.x, at.y - away.y}, colour);
        add({at.x + away.x, at.y + away.y}, faded(colour, 0));
    }
    const auto n = static_cast<std::uint32_t>(count);
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t here = first + 2 * i, next = first + 2 * ((i + 1) % n);
        if (i >= 2) triangle(first, here - 2, here);
        triangle(here, here + 1, next + 1);
        triangle(here, next + 1, next);
    }
}

void Mesh::stroke(const Spot& from, const Spot& to, double width, const Ink& colour) {
    const Spot side = normal(from, to);
    const double inner = std::max(width / 2 - 0.5, 0.0), outer = std::max(width / 2 + 0.5, 1.0);
    const auto at = [&](const Spot& spot, double way) {
        return Spot{spot.x + way * side.x, spot.y + way * side.y};
    };
    const Ink shown = width < 1 ? faded(colour, width) : colour, clear = faded(colour, 0);
    quad({at(from, outer), at(to, outer), at(to, inner), at(from, inner)}, {clear, clear, shown, shown});
    quad({at(from, inner), at(to, inner), at(to, -inner), at(from, -inner)}, shown);
    quad({at(from, -inner), at(to, -inner), at(to, -outer), at(from, -outer)}, {shown, shown, clear, clear});
}

void Mesh::path(std::span<const Spot> points, double width, const Ink& colour) {
    for (std::size_t i = 1; i < points.size(); ++i) stroke(points[i - 1], points[i], width, colour);
}

void Mesh::ring(const Spot& middle, double radius, double width, const Ink& colour) {
    for (int i = 0; i < kCorners; ++i) {
        stroke(on_ellipse(middle, {radius, radius}, i), on_ellipse(middle, {radius, radius}, i + 1), width,
               colour);
    }
}

}  // namespace thimble
