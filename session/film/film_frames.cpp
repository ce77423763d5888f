#include <cmath>

#include <fmt/format.h>

#include "session/film/film.hpp"

namespace thimble {

std::size_t frame_count(double duration_s, double frames_per_s) {
    // A duration that is a whole number of periods, but for rounding, has its last frame.
    return static_cast<std::size_t>(std::floor(duration_s * frames_per_s + 1e-9)) + 1;
}

std::filesystem::path frame_file(const std::filesystem::path& folder, std::size_t frame) {
    return folder / fmt::format("frame_{:06}.png", frame);
}

}  // namespace thimble
