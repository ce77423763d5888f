#include "cutaneous_node/cutaneous_settings.hpp"

namespace thimble {

CutaneousSettings read_cutaneous_settings(const ConfigTable& table) {
    using std::chrono::microseconds;
    using std::chrono::milliseconds;
    using std::chrono::seconds;
    CutaneousSettings node;
    node.dead_time = table.seconds("dead_time_s", node.dead_time, Duration::zero(), seconds{1});
    node.time_constant = table.seconds("time_constant_s", node.time_constant, Duration::zero(), seconds{1});
    node.force_limit_N = table.number("force_limit_N", node.force_limit_N, 0.01, 20);
    node.stale_after = table.seconds("stale_after_s", node.stale_after, milliseconds{2}, seconds{10});
    node.percept_period =
        table.seconds("percept_period_s", node.percept_period, microseconds{100}, milliseconds{100});
    node.device = static_cast<FingertipDevice>(table.choice("device", 0, {"simulated", "board", "drives"}));
    node.board = read_hid_choice(table.table("board"));
    node.drives = read_drive_settings(table.table("drives"));
    if (node.device == FingertipDevice::kDrives && node.drives.bus.empty()) {
        table.fail("device", "is \"drives\", but [cutaneous.drives] has no bus, e.g. bus = \"can0\"");
    }
    return node;
}

}  // namespace thimble
