#include "cutaneous_node/cutaneous_settings.hpp"

#include <fmt/format.h>

namespace thimble {

CutaneousSettings read_cutaneous_settings(const ConfigTable& table) {
    using std::chrono::microseconds;
    using std::chrono::milliseconds;
    using std::chrono::seconds;
    CutaneousSettings node;
    node.dead_time = table.seconds("dead_time_s", node.dead_time, Duration::zero(), seconds{1});
    node.time_constant = table.seconds("time_constant_s", node.time_constant, Duration::zero(), seconds{1});
    node.force_limit_N = table.number("force_limit_N", node.force_limit_N, 0.01, 20);
    node.stale = read_stale_policy(table, node.stale, milliseconds{2}, seconds{10});
    node.percept_period =
        table.seconds("percept_period_s", node.percept_period, microseconds{100}, milliseconds{100});
    node.device = static_cast<FingertipDevice>(table.choice("device", 0, {"simulated", "board", "drives"}));
    node.board = read_hid_choice(table.table("board"));
    node.drives = read_drive_settings(table.table("drives"));
    if (node.device == FingertipDevice::kDrives && node.drives.bus.empty()) {
        table.fail("device", "is \"drives\", but [cutaneous.drives] has no bus, e.g. bus = \"can0\"");
    }
    node.guard_limit_N = table.number("guard_limit_N", node.guard_limit_N, 0.01, 20);
    if (node.force_limit_N > node.guard_limit_N) {
        table.fail("force_limit_N",
                   fmt::format("is {:g}, but the guard before the device lets {:g} N through: "
                               "raise guard_limit_N as well, on purpose",
                               node.force_limit_N, node.guard_limit_N));
    }
    return node;
}

}  // namespace thimble
