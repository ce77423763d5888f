#include "cutaneous_node/cutaneous_settings.hpp"

namespace thimble {

CutaneousSettings read_cutaneous_settings(const ConfigTable& table) {
    CutaneousSettings node;
    table.read("device", node.device, {"simulated", "board", "drives"},
               "A fingertip board on USB or motors on a CAN bus; in virtual time always the first.");
    table.read("dead_time_s", node.dead_time, 0, 1,
               "simulated: from a command to the first motion of the cables.");
    table.read("time_constant_s", node.time_constant, 0, 1, "simulated: first-order lag after it; 0: none.");
    table.read("force_limit_N", node.force_limit_N, 0.01, 20,
               "The most the device presses; equal to [operator] full_scale_cutaneous_N.");
    table.read("guard_limit_N", node.guard_limit_N, 0.01, 20,
               "No more leaves for the device, whoever asks; force_limit_N may not be larger.");
    node.stale = read_stale_policy(table, node.stale, std::chrono::milliseconds{2}, std::chrono::seconds{10});
    table.read("percept_period_s", node.percept_period, 1e-4, 0.1, "How often the skin reports.");
    node.board = read_hid_choice(table.table("board"));
    node.drives = read_drive_settings(table.table("drives"));
    if (node.device == FingertipDevice::kDrives && node.drives.bus.empty()) {
        table.fail("device", "is \"drives\", but [cutaneous.drives] has no bus, e.g. bus = \"can0\"");
    }
    if (node.force_limit_N > node.guard_limit_N) {
        table.fail("force_limit_N",
                   "is {:g}, but the guard before the device lets {:g} N through: raise guard_limit_N as "
                   "well, on purpose",
                   node.force_limit_N, node.guard_limit_N);
    }
    return node;
}

}  // namespace thimble
