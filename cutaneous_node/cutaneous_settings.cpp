#include "cutaneous_node/cutaneous_settings.hpp"

namespace thimble {

CutaneousSettings read_cutaneous_settings(const ConfigTable& table) {
    CutaneousSettings node;
    table.read("device", node.device, {"simulated", "board", "drives", "touchdiver"},
               "The fingertip device. board: USB; drives: motors on a CAN bus; touchdiver: WEART TouchDIVER. "
               "In virtual time always simulated.");
    table.read("dead_time_s", node.dead_time, 0, 1,
               "simulated: time from a command to the first motion of the cables.");
    table.read("time_constant_s", node.time_constant, 0, 1,
               "simulated: time constant of the first-order lag after that; 0: none.");
    table.read("force_limit_N", node.force_limit_N, 0.01, 20,
               "Force limit of the device; equal to [operator] full_scale_cutaneous_N.");
    table.read("guard_limit_N", node.guard_limit_N, 0.01, 20,
               "Force limit of the guard before the device; at least force_limit_N.");
    node.stale = read_stale_policy(table, node.stale, std::chrono::milliseconds{2}, std::chrono::seconds{10});
    table.read("percept_period_s", node.percept_period, 1e-4, 0.1,
               "Time between two reports of the force on the skin.");
    node.board = read_hid_choice(table.table("board"));
    node.drives = read_drive_settings(table.table("drives"));
    node.touchdiver = read_touchdiver_settings(table.table("touchdiver"));
    if (node.device == FingertipDevice::kDrives && node.drives.bus.empty()) {
        table.fail("device", "is \"drives\", but [cutaneous.drives] names no bus, e.g. bus = \"can0\"");
    }
    if (node.force_limit_N > node.guard_limit_N) {
        table.fail("force_limit_N",
                   "is {:g}, but the guard before the device limits the force to {:g} N: to allow more, "
                   "raise guard_limit_N as well",
                   node.force_limit_N, node.guard_limit_N);
    }
    if (!node.drives.bus.empty() && node.drives.resting_N() + node.force_limit_N > node.guard_limit_N) {
        table.table("drives").fail(
            "pretension_N",
            "presses each finger with {:.3g} N at rest; with force_limit_N, {:g} N, this is more than "
            "guard_limit_N, {:g} N: lower pretension_N or force_limit_N, or raise guard_limit_N",
            node.drives.resting_N(), node.force_limit_N, node.guard_limit_N);
    }
    return node;
}

}  // namespace thimble
