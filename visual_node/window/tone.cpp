#include <algorithm>
#include <cmath>
#include <numbers>

#include "visual_node/window/beeper.hpp"

namespace thimble {

std::vector<std::int16_t> samples_of(const Tone& tone, int rate_Hz) {
    const auto count = static_cast<std::size_t>(std::lround(tone.length_s * rate_Hz));
    std::vector<std::int16_t> samples(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double time_s = static_cast<double>(i) / rate_Hz;
        const double fade = std::clamp(std::min(time_s, tone.length_s - time_s) / tone.fade_s, 0.0, 1.0);
        const double wave = std::sin(2 * std::numbers::pi * tone.frequency_Hz * time_s);
        samples[i] = static_cast<std::int16_t>(std::lround(32767 * tone.loudness * fade * wave));
    }
    return samples;
}

}  // namespace thimble
