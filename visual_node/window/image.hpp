// A picture in memory and as a file, and the colours of the ground and of the subject's scene.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "common/colours.hpp"

namespace thimble {

using Rgb = Colour;

struct Image {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;  // rows from the top, three bytes per pixel

    Rgb at(int x, int y) const {
        const std::size_t i =
            3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
        return {rgb[i], rgb[i + 1], rgb[i + 2]};
    }
};

// Around the curves, in views.
inline constexpr Colour kBackground{16, 17, 20};
inline constexpr Colour kGrid{58, 62, 70};
inline constexpr Colour kFaded{140, 144, 150};  // text of what is old

// Of the subject's scene.
namespace colours {
inline constexpr Colour kBackground{28, 32, 40};
inline constexpr Colour kNeedle = kWhite;
inline constexpr Colour kTissue{150, 208, 240};  // the surface's sky blue, lightened
inline constexpr Colour kBar = kOrange;
inline constexpr Colour kBarGround{52, 58, 70};
inline constexpr Colour kInk{225, 228, 232};
inline constexpr Colour kSkin{213, 120, 100};
inline constexpr Colour kBlanched{250, 226, 214};
}  // namespace colours

// A PNG file, 8 bits per colour, no alpha, appears whole or not at all. Throws Error (data) if it cannot be written.
void write_png(const std::filesystem::path& path, const Image& image);
// Throws Error (data) if the file is missing or no PNG.
Image read_png(const std::filesystem::path& path);

}  // namespace thimble
