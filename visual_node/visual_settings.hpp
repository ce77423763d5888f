// The table [visual]:
//   refresh_Hz = 60          frames per second
//   pipeline_s = 0.025       from drawing a frame to light
//   bar_full_scale_N = 12    the longest bar
//   bar_resolution = 400     its length in pixels
//   stale = "zero"           the bar without feedback: at 0 at once ("zero"), "ramp" or "hold"; a window says so in words
//   stale_after_s = 0.1      without feedback for so long
//   stale_ramp_s = 0.02      of "ramp": how long the bar takes to fall
//   display = "recording"    or "window": where frames go
//   smoothing_s = 0          a window shows the past by so much, to interpolate what jitter tears apart
//   pointer_m_per_count = 5e-5   of a mouse's count at the hand, view "player"
//   fingertip = false        CF and CCF as the picture of a fingertip: for a person without the devices
//   sound = true             a window beeps
//   fullscreen = false       a window fills the screen
// and, so that a value that two programs must agree on stands once, what this node must know of other tables.
//   vibration = true         in CF and CCF a player's gamepad vibrates, where it can
//   vibration_device = ""    its event device, /dev/input/eventN; empty: it is sought
#pragma once

#include <cstdint>
#include <string>

#include "common/config.hpp"
#include "common/shared_values.hpp"
#include "common/stale_policy.hpp"
#include "common/time.hpp"

namespace thimble {

struct VisualSettings {
    double refresh_Hz = 60;
    Duration pipeline = std::chrono::milliseconds{25};
    double bar_full_scale_N = kBarFullScale_N;
    std::int64_t bar_resolution = 400;
    StalePolicy stale{StaleMode::kZero};
    bool window = false;
    bool refresh_given =
        false;  // a window takes scenes as often as they come, unless the file says how often
    Duration smoothing{};
    double pointer_m_per_count = 5e-5;
    bool fingertip = false;
    bool sound = true;
    bool fullscreen = false;
    bool pointer = false;          // [handle] device = "pointer": the mouse in the window is the hand
    bool subject_goes_on = false;  // [protocol] next_by
    bool vibration = true;
    std::string vibration_device{};
};

// Of [visual] alone, and of the whole file. Throw Error (usage).
VisualSettings read_visual_settings(const ConfigTable& table);
VisualSettings read_visual_settings(const ConfigFile& file);

// [protocol] next_by = "experimenter" or "subject": who says, at the end of a page, that the next trial may begin. The
// experimenter may always. Throws Error (usage).
bool read_subject_goes_on(const ConfigTable& protocol);

}  // namespace thimble
