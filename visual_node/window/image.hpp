// A picture in memory and as a file, and the colours of all that is drawn.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace thimble {

using Rgb = std::array<std::uint8_t, 3>;  // 0 to 255, sRGB

struct Image {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;  // rows from the top, three bytes per pixel

    Rgb at(int x, int y) const {
        const std::size_t i =
            3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
        return {rgb[i], rgb[i + 1], rgb[i + 2]};
    }
};

// Eight colours that people with any common colour blindness tell apart (Okabe and Ito 2008, "Color Universal
// Design"), by their names there, and what is drawn in them. Views never tell by colour alone: lines differ in their dashes as
// well, and needle, tissue and bar of the subject's scene in lightness.
using Colour = Rgb;

inline constexpr Colour kBlack{0, 0, 0};
inline constexpr Colour kOrange{230, 159, 0};
inline constexpr Colour kSkyBlue{86, 180, 233};
inline constexpr Colour kBluishGreen{0, 158, 115};
inline constexpr Colour kYellow{240, 228, 66};
inline constexpr Colour kBlue{0, 114, 178};
inline constexpr Colour kVermillion{213, 94, 0};  // the red of this set
inline constexpr Colour kReddishPurple{204, 121, 167};

// Around them, in views.
inline constexpr Colour kWhite{255, 255, 255};
inline constexpr Colour kBackground{16, 17, 20};
inline constexpr Colour kGrid{58, 62, 70};
inline constexpr Colour kFaded{140, 144, 150};  // text of what is old

// Of the subject's scene.
namespace colours {
inline constexpr Colour kBackground{28, 32, 40};
inline constexpr Colour kNeedle = kWhite;
inline constexpr Colour kTissue{150, 208, 240};  // sky blue, lightened
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
