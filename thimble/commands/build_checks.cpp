#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "common/error.hpp"
#include "session/launch/ros2_programs.hpp"
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

void check_build(const SystemSettings& settings) {
    check_driver(settings.launch, Role::kMaster, driven_handle(settings.handle.kind));
    for (const Ros2Program& ros2 : ros2_programs(settings)) {
        if (settings.launch.own_program(ros2.role).empty()) path_of(ros2);
    }
    const bool board = settings.cutaneous.device == FingertipDevice::kBoard;
    check_driver(settings.launch, Role::kCutaneous, board ? "[cutaneous] device = \"board\"" : nullptr);
#ifdef THIMBLE_GUI
    const std::string words = settings.pages.text();
    if (words.find_first_not_of('\n') != std::string::npos) check_drawable(words);
#endif
}

}  // namespace thimble
