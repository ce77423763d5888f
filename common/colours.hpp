// The colours of windows and figures, sRGB: one set for both, so that a thing keeps its hue wherever it is drawn.
#pragma once

#include <array>
#include <cstdint>

#include <fmt/format.h>

namespace thimble {

struct Colour : std::array<std::uint8_t, 3> {};  // 0 to 255; formatted as "#0072B2"

// Eight colours that people with any common colour blindness tell apart (Okabe and Ito 2008, "Color Universal Design"), by their
// names there. Colour never stands alone: lines also differ in their dashes, areas in lightness.
inline constexpr Colour kBlack{0, 0, 0};
inline constexpr Colour kOrange{230, 159, 0};
inline constexpr Colour kSkyBlue{86, 180, 233};
inline constexpr Colour kBluishGreen{0, 158, 115};
inline constexpr Colour kYellow{240, 228, 66};
inline constexpr Colour kBlue{0, 114, 178};
inline constexpr Colour kVermillion{213, 94, 0};  // the red of this set
inline constexpr Colour kReddishPurple{204, 121, 167};

inline constexpr Colour kWhite{255, 255, 255};
inline constexpr Colour kGrey{153, 153, 153};

// Curves of the needle are warm, curves of the tissue surface are blue; the ground decides how light they are.
inline constexpr Colour kNeedleOnDark = kOrange, kNeedleOnLight = kVermillion;
inline constexpr Colour kSurfaceOnDark = kSkyBlue, kSurfaceOnLight = kBlue;

}  // namespace thimble

template <>
struct fmt::formatter<thimble::Colour> {
    constexpr auto parse(format_parse_context& context) { return context.begin(); }
    auto format(const thimble::Colour& colour, format_context& context) const {
        return fmt::format_to(context.out(), "#{:02X}{:02X}{:02X}", colour[0], colour[1], colour[2]);
    }
};
