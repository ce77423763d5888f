// The table [visual] of a session file (docs/session-files.md), and, so that a value that two programs must agree on stands once,
// the keys of other tables that this node must know.
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
