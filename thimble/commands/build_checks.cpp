#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "common/error.hpp"
#include "thimble/commands/shared.hpp"
#ifdef THIMBLE_GUI
#include "visual_node/window/gui_layer.hpp"
#endif

namespace thimble {
namespace {

#ifdef THIMBLE_DEVICES
constexpr bool kDevices = true;
#else
constexpr bool kDevices = false;
#endif

// The device that is asked for and needs a driver; null: none does.
const char* driven_handle(HandleKind kind) {
    if (kind == HandleKind::kHid) return "[handle] device = \"hid\"";
    return kind == HandleKind::kFalcon ? "[handle] device = \"falcon\"" : nullptr;
}

void check_driver(const LaunchSettings& launch, Role role, const char* device) {
    if (kDevices || device == nullptr || !launch.machine(role).empty()) return;
    throw Error(ExitCode::kUsage,
                fmt::format("this build has no driver for {}: install libhidapi-dev, libusb-1.0-0-dev and "
                            "libsodium-dev, and build with -DTHIMBLE_DEVICES=ON",
                            device));
}

}  // namespace

std::filesystem::path ros2_master() {
    auto master = program_folder() / "thimble-ros2-master";
    if (std::filesystem::exists(master)) return master;
    throw Error(
        ExitCode::kUsage,
        "[handle] device = \"ros2\" needs {}, which is not there: install the package thimble-ros2, or "
        "build with -DTHIMBLE_ROS2=ON",
        master.string());
}

void check_build(const SystemSettings& settings) {
    check_driver(settings.launch, Role::kMaster, driven_handle(settings.handle.kind));
    const bool ros2 = settings.handle.kind == HandleKind::kRos2;
    if (ros2 && settings.launch.own_program(Role::kMaster).empty()) ros2_master();
    const bool board = settings.cutaneous.device == FingertipDevice::kBoard;
    check_driver(settings.launch, Role::kCutaneous, board ? "[cutaneous] device = \"board\"" : nullptr);
#ifdef THIMBLE_GUI
    const std::string words = settings.pages.text();
    if (words.find_first_not_of('\n') != std::string::npos) check_drawable(words);
#endif
}

}  // namespace thimble
