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

enum class BeepShown : std::uint8_t { kWithoutSound, kAlways, kHidden };

struct VisualSettings {
    double refresh_Hz = 60;
    Duration pipeline = std::chrono::milliseconds{25};
    double bar_full_scale_N = kBarFullScale_N;
    std::int64_t bar_resolution = 400;
    StalePolicy stale{StaleMode::kZero};
    bool picture_delayed = false;
    bool window = false;
    bool refresh_given =
        false;  // a window takes scenes as often as they come, unless the file says how often
    Duration smoothing{};
    double pointer_m_per_count = 5e-5;
    bool fingertip = false;
    bool cut_away = false;  // scenes for the cut-away view: never of a subject
    bool sound = true;
    BeepShown beep_shown = BeepShown::kWithoutSound;
    bool fullscreen = false;
    bool pointer = false;   // [handle] device = "pointer" or "keyboard": the hand is read in the window
    bool keyboard = false;  // and it is the arrow keys, not the mouse
    bool hid = false;       // [handle] device = "hid": the master reads the hand
    double position_scale = kPositionScale;  // [master]: needle = scale x hand
    bool subject_goes_on = false;            // [protocol] next_by
    bool vibration = true;
    std::string vibration_device{};
};

// [protocol] next_by = "experimenter" or "subject": who says, at the end of a page, that the next trial may begin. The
// experimenter may always. Throws Error (usage).
inline bool read_subject_goes_on(const ConfigTable& protocol) {
    bool goes_on = false;
    protocol.read("next_by", goes_on, {"experimenter", "subject"},
                  "Person who starts the next trial where a page waits: the experimenter, or the subject by "
                  "the space bar or a click.");
    return goes_on;
}

// [protocol] break_text. The experimenter's terminal has it, too.
inline std::string read_break_text(const ConfigTable& protocol) {
    std::string text = "Please take your hand off the handle and rest.";
    protocol.read("break_text", text, "Text on the screen during a break, unless [instructions] has one.");
    return text;
}

// Of [visual] alone, and of the whole file. Throw Error (usage).
inline VisualSettings read_visual_settings(const ConfigTable& table) {
    VisualSettings node;
    table.read("refresh_Hz", node.refresh_Hz, 1, 1000,
               "Frames per second; a window without this key computes scenes at 1000 Hz.");
    node.refresh_given = table.has("refresh_Hz");
    table.read("pipeline_s", node.pipeline, 0, 1, "Time from drawing a frame to light on the screen.");
    table.read("bar_full_scale_N", node.bar_full_scale_N, 0.1, 100,
               "Force of the longest bar; equal to [operator] full_scale_bar_N.");
    table.read("bar_resolution", node.bar_resolution, 1, 10'000, "Length of the longest bar, pixels.");
    node.stale = read_stale_policy(table, node.stale, std::chrono::milliseconds{2}, std::chrono::seconds{10});
    table.read(
        "picture_delayed", node.picture_delayed,
        "true: needle and surface arrive with the force, equally late; false: at once, as in the paper.");
    table.read("display", node.window, {"recording", "window"},
               "recording: count frames only; window: draw them on the screen (docs/visual.md).");
    table.read("smoothing_s", node.smoothing, 0, 0.1,
               "Time by which a window shows the past, interpolated; hides jitter. 0: the newest sample.");
    table.read("pointer_m_per_count", node.pointer_m_per_count, 1e-7, 0.01,
               "Movement of the hand per count of the mouse, where the mouse is the hand.");
    table.read("fingertip", node.fingertip,
               "true: show CF and CCF as the picture of a fingertip, for a person without devices (always "
               "with --role player).");
    table.read("sound", node.sound, "true: the window plays the beep.");
    table.read("beep_shown", node.beep_shown, {"without_sound", "always", "never"},
               "When a window also shows the beep, as a bright frame.");
    table.read("fullscreen", node.fullscreen, "true: the window fills the screen; so does --fullscreen.");
    table.read("vibration", node.vibration,
               "true: with --role player a gamepad vibrates in CF and CCF, if it has motors (docs/play.md).");
    table.read("vibration_device", node.vibration_device,
               "Event device of the gamepad, /dev/input/eventN; empty: searched for.");
    return node;
}

// Only the master knows the list of devices.
inline VisualSettings read_visual_settings(const ConfigFile& file) {
    VisualSettings node = read_visual_settings(file.table("visual"));
    std::string handle;
    file.table("handle").read("device", handle, "");
    node.keyboard = handle == "keyboard";
    node.pointer = node.keyboard || handle == "pointer";
    node.hid = handle == "hid";
    file.table("master").read("position_scale", node.position_scale, 0.01, 100, "");
    node.subject_goes_on = read_subject_goes_on(file.table("protocol"));
    return node;
}

}  // namespace thimble
