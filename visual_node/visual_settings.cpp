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
    node.stale_after = table.seconds("stale_after_s", node.stale_after, milliseconds{2}, seconds{10});
    return node;
}

}  // namespace thimble
