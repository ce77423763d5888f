// Eight colours that people with any common colour blindness tell apart (Okabe and Ito 2008, "Color Universal
// Design"), by their names there. Views never tell by colour alone: lines differ in their dashes as well.
#pragma once

#include <cstdint>

namespace thimble {

struct Colour {
    std::uint8_t red = 0, green = 0, blue = 0;
    bool operator==(const Colour&) const = default;
};

inline constexpr Colour kBlack{0, 0, 0};
inline constexpr Colour kOrange{230, 159, 0};
inline constexpr Colour kSkyBlue{86, 180, 233};
inline constexpr Colour kBluishGreen{0, 158, 115};
inline constexpr Colour kYellow{240, 228, 66};
inline constexpr Colour kBlue{0, 114, 178};
inline constexpr Colour kVermillion{213, 94, 0};  // the red of this set
inline constexpr Colour kReddishPurple{204, 121, 167};

// Around them.
inline constexpr Colour kWhite{255, 255, 255};
inline constexpr Colour kBackground{16, 17, 20};
inline constexpr Colour kGrid{58, 62, 70};
inline constexpr Colour kFaded{140, 144, 150};  // text of what is old

}  // namespace thimble
