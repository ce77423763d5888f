// The table [visual]:
//   refresh_Hz = 60          frames per second
//   pipeline_s = 0.025       from drawing a frame to light
//   bar_full_scale_N = 12    the longest bar
//   bar_resolution = 400     its length in pixels
//   stale_after_s = 0.1      without feedback for so long, the bar drops to 0
#pragma once

#include <cstdint>

#include "common/config.hpp"
#include "common/time.hpp"

namespace thimble {

struct VisualSettings {
    double refresh_Hz = 60;
    Duration pipeline = std::chrono::milliseconds{25};
    double bar_full_scale_N = 12;
    std::int64_t bar_resolution = 400;
    Duration stale_after = std::chrono::milliseconds{100};
};

VisualSettings read_visual_settings(const ConfigTable& table);

}  // namespace thimble
