#include "visual_node/visual_settings.hpp"

namespace thimble {

VisualSettings read_visual_settings(const ConfigTable& table) {
    using std::chrono::milliseconds;
    using std::chrono::seconds;
    VisualSettings node;
    node.refresh_Hz = table.number("refresh_Hz", node.refresh_Hz, 1, 1000);
    node.pipeline = table.seconds("pipeline_s", node.pipeline, Duration::zero(), seconds{1});
    node.bar_full_scale_N = table.number("bar_full_scale_N", node.bar_full_scale_N, 0.1, 100);
    node.bar_resolution = table.integer("bar_resolution", node.bar_resolution, 1, 10'000);
    node.stale = read_stale_policy(table, node.stale, milliseconds{2}, seconds{10});
    node.window = table.choice("display", 0, {"recording", "window"}) == 1;
    node.refresh_given = table.has("refresh_Hz");
    node.smoothing = table.seconds("smoothing_s", node.smoothing, Duration::zero(), milliseconds{100});
    node.pointer_m_per_count = table.number("pointer_m_per_count", node.pointer_m_per_count, 1e-7, 0.01);
    node.fingertip = table.boolean("fingertip", node.fingertip);
    node.sound = table.boolean("sound", node.sound);
    node.fullscreen = table.boolean("fullscreen", node.fullscreen);
    node.vibration = table.boolean("vibration", node.vibration);
    node.vibration_device = table.text("vibration_device", "");
    return node;
}

// Which devices there are is the master's to know.
VisualSettings read_visual_settings(const ConfigFile& file) {
    VisualSettings node = read_visual_settings(file.table("visual"));
    node.pointer = file.table("handle").text("device", "") == "pointer";
    node.subject_goes_on = read_subject_goes_on(file.table("protocol"));
    return node;
}

bool read_subject_goes_on(const ConfigTable& protocol) {
    return protocol.choice("next_by", 0, {"experimenter", "subject"}) == 1;
}

}  // namespace thimble
