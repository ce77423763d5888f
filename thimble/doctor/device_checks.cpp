#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "thimble/doctor/checks.hpp"

namespace thimble {
namespace {

constexpr const char* kRulesCommand =
    "sudo cp deploy/udev/70-thimble-*.rules /etc/udev/rules.d/ && sudo udevadm control --reload && "
    "sudo udevadm trigger";

// Twelve targets, heartbeat, SYNC and one more.
constexpr int kQueueFrames = 15;

using Device = DeviceFacts::Device;

std::optional<DeviceUse> use_of_handle(const std::string& device) {
    if (device == "hid") return DeviceUse::kHidHand;
    if (device == "force-dimension") return DeviceUse::kForceDimension;
    if (device == "falcon") return DeviceUse::kFalcon;
    return std::nullopt;
}

std::vector<Device> devices_for(const DeviceFacts& facts, std::optional<DeviceUse> use, bool fingertip) {
    std::vector<Device> found;
    for (const Device& device : facts.devices) {
        const bool board = device.use == DeviceUse::kFingertipBoard;
        if (board == fingertip && (!use || device.use == *use)) found.push_back(device);
    }
    return found;
}

std::string list_of(const std::vector<Device>& devices) {
    std::vector<std::string> words;
    words.reserve(devices.size());
    for (const Device& device : devices) {
        words.push_back(device.name +
                        (device.use == DeviceUse::kUnusable ? ", which cannot move the needle" : ""));
    }
    return words.empty() ? "none" : fmt::format("{}", fmt::join(words, "; "));
}

// `wanted`: the session does not run, or runs without a hand, if there is none that may be opened.
Diagnosis judge_devices(const DeviceFacts& facts, const std::vector<Device>& devices, bool wanted,
                        Diagnosis finding) {
    const auto with_access = [&](bool accessible) {
        return std::find_if(devices.begin(), devices.end(), [&](const Device& device) {
            return device.use != DeviceUse::kUnusable && device.accessible == accessible;
        });
    };
    const auto closed = with_access(false);
    const bool usable = with_access(true) != devices.end();
    if (wanted && usable) return finding;
    if (closed != devices.end()) {
        const bool rules = !facts.rules.empty();
        return finding.adds(
            wanted ? Severity::kFault : Severity::kNote,
            fmt::format("; this user may not open {} at {} ({})", closed->name, closed->node,
                        rules
                            ? "log in at this machine's own screen, or unplug the device and plug it in again"
                            : "no udev rule of Thimble is installed"),
            rules ? "sudo udevadm trigger --action=add" : kRulesCommand);
    }
    if (!wanted) return finding;
    return finding.adds(Severity::kFault, "; the device that this session names is not plugged in", "lsusb");
}

}  // namespace

Diagnosis check_handle(const Facts& facts) {
    const auto use = use_of_handle(facts.session.handle);
    const auto found = devices_for(facts.devices, use, false);
    Diagnosis finding{"handle"};
    finding.says =
        fmt::format("[handle] device = \"{}\"; plugged in: {}", facts.session.handle, list_of(found));
    if (facts.session.human && facts.session.handle == "simulated") {
        return finding.adds(Severity::kWarning,
                            "; for a person set device to \"pointer\", \"keyboard\" or a real handle, or use "
                            "programs that run already (--attach)");
    }
    return judge_devices(facts.devices, found, use.has_value(), std::move(finding));
}

Diagnosis check_fingertip(const Facts& facts) {
    const std::string& device = facts.session.fingertip;
    const auto found = devices_for(facts.devices, std::nullopt, true);
    Diagnosis finding{"fingertip"};
    if (!facts.session.middleware_problem.empty())
        return finding.is(Severity::kFault,
                          "[cutaneous] device = \"touchdiver\"; " + facts.session.middleware_problem +
                              ": start WEART's middleware or WEART-App there",
                          "ss -tln   # on that machine: who listens");
    finding.says = fmt::format("[cutaneous] device = \"{}\"; boards plugged in: {}", device, list_of(found));
    if (facts.session.human && !facts.session.cutaneous_drawn)
        return finding.adds(Severity::kWarning,
                            "; a person would not feel or see CF and CCF: set [visual] fingertip = true");
    return judge_devices(facts.devices, found, device == "board", std::move(finding));
}

Diagnosis check_device_software(const Facts& facts) {
    Diagnosis finding{"device driver"};
    const std::string& problem = facts.session.software_problem;
    const std::string& handle = facts.session.handle;
    if (!problem.empty())
        return finding.is(Severity::kFault, problem,
                          problem.find("thimble-ros2") != std::string::npos
                              ? "sudo apt-get install ./out/package/thimble-ros2_*.deb"
                          : handle == "falcon" ? "sha256sum FIRMWARE"
                          : handle == "haply"  ? "systemctl status haply-inverse-service"
                          : handle == "touch"  ? "ldconfig -p | grep libHD"
                                               : "export FDSDK=/path/to/the/sdk");
    return finding.is(
        Severity::kOk,
        "the devices of this session have all the SDKs, services, firmware and programs that they need");
}

Diagnosis check_can(const Facts& facts) {
    Diagnosis finding{"CAN"};
    const std::string& bus = facts.session.can_bus;
    const bool wanted = !bus.empty();
    auto interfaces = facts.can.interfaces;
    if (wanted) std::erase_if(interfaces, [&](const auto& interface) { return interface.name != bus; });
    const auto up = std::find_if(interfaces.begin(), interfaces.end(),
                                 [](const CanFacts::Interface& interface) { return interface.up; });
    if (up != interfaces.end()) {
        finding.says = fmt::format("{} is up", up->name);
        if (!wanted || up->queue_frames == 0 || up->queue_frames >= kQueueFrames) return finding;
        return finding.adds(Severity::kWarning,
                            fmt::format(", and its queue holds {} frames; twelve drives need {}",
                                        up->queue_frames, kQueueFrames),
                            fmt::format("sudo ip link set {} txqueuelen 100", up->name));
    }
    const Severity lacking = wanted ? Severity::kFault : Severity::kNote;
    if (!interfaces.empty()) {
        const std::string& name = interfaces.front().name;
        return finding.is(lacking, fmt::format("{} is down", name),
                          fmt::format("sudo ip link set {} up type can bitrate 1000000", name));
    }
    if (wanted && facts.kernel.can)
        return finding.is(lacking, fmt::format("there is no interface {}", bus), "ip -br link show type can");
    if (facts.kernel.can) {
        return finding.is(lacking, "no interface; needed only for a fingertip device with CAN drives",
                          "sudo ip link add vcan0 type vcan   # a virtual one, to try");
    }
    return finding.is(lacking,
                      "this kernel has no CAN; needed only for a fingertip device with CAN drives, unless "
                      "its bus is reached over UDP",
                      "sudo modprobe can_raw");
}

namespace {

// The worst of the session's interfaces.
Diagnosis judge_interface(const Ros2Facts::Interface& interface, Diagnosis finding) {
    if (interface.name.empty())
        return finding.adds(Severity::kFault,
                            fmt::format("; no interface of this machine has {}", interface.address),
                            "ip -4 address");
    const std::string name = fmt::format("; {} at {}", interface.name, interface.address);
    if (!interface.up)
        return finding.adds(Severity::kFault, name + " is down",
                            fmt::format("sudo ip link set {} up", interface.name));
    if (!interface.multicast)
        return finding.adds(Severity::kFault,
                            name + " has no multicast, which DDS needs to find other programs",
                            fmt::format("sudo ip link set {} multicast on", interface.name));
    return finding.adds(finding.severity, name + " has multicast", finding.remedy);
}

}  // namespace

Diagnosis check_ros2(const Facts& facts) {
    const Ros2Facts& ros2 = facts.ros2;
    Diagnosis finding{"ROS 2", ExitCode::kUsage};
    if (!ros2.domain_problem.empty())
        return finding.is(ros2.wanted ? Severity::kFault : Severity::kNote, ros2.domain_problem,
                          "unset ROS_DOMAIN_ID");
    finding.says = ros2.domain.empty() ? "domain 0, as ROS_DOMAIN_ID is not set"
                                       : fmt::format("domain {}, by ROS_DOMAIN_ID", ros2.domain);
    if (ros2.rmw.find("zenoh") != std::string::npos) {
        finding.adds(ros2.wanted ? Severity::kWarning : Severity::kNote,
                     fmt::format("; RMW_IMPLEMENTATION is {}, which does not use DDS: a device that runs "
                                 "with it cannot be reached",
                                 ros2.rmw),
                     "export RMW_IMPLEMENTATION=rmw_cyclonedds_cpp");
    } else if (!ros2.rmw.empty()) {
        finding.says += fmt::format("; RMW_IMPLEMENTATION is {}", ros2.rmw);
    }
    for (const auto& interface : ros2.interfaces) {
        if (finding.severity != Severity::kFault) finding = judge_interface(interface, std::move(finding));
    }
    if (!ros2.wanted && finding.severity == Severity::kFault) finding.severity = Severity::kNote;
    return finding;
}

Diagnosis check_screen(const Facts& facts) {
    const ScreenFacts& screen = facts.screen;
    Diagnosis finding{"OpenGL", ExitCode::kUsage};
    const bool wanted = facts.session.window || facts.session.human;
    const Severity lacking = wanted ? Severity::kFault : Severity::kNote;
    if (!screen.built) {
        return finding.is(lacking, "this build has no windows (THIMBLE_GUI is off); thimble play needs them",
                          "cmake --preset release -DTHIMBLE_GUI=ON && cmake --build --preset release");
    }
    if (!screen.problem.empty()) {
        return finding.is(lacking, "thimble play and windows: " + screen.problem,
                          screen.problem.rfind("no screen", 0) == 0
                              ? "export DISPLAY=:0   # where this user's desktop runs on this machine"
                              : "sudo apt-get install libgl1-mesa-dri");
    }
    finding.says = fmt::format("{}, drawn by {}", screen.version, screen.renderer);
    if (screen.renderer.find("llvmpipe") == std::string::npos) return finding;
    return finding.adds(Severity::kWarning, ": in software, on the processors that the force loop needs",
                        "glxinfo -B   # which driver is used, and why");
}

Diagnosis check_sound(const Facts& facts) {
    Diagnosis finding{"sound", ExitCode::kUsage};
    if (facts.sound.built && facts.sound.problem.empty())
        return finding.is(Severity::kOk, "the sound device for the beep works");
    finding.says = facts.sound.built ? "the beep is only shown: " + facts.sound.problem
                                     : "this build has no sound (THIMBLE_GUI or THIMBLE_AUDIO is off)";
    if (!facts.session.human || facts.session.beep_shown)
        return finding.adds(Severity::kNote, "", facts.sound.built ? "aplay -l" : "");
    return finding.adds(Severity::kFault,
                        "; a person must hear it. To show it as well, set [visual] beep_shown = \"always\"",
                        "aplay -l");
}

}  // namespace thimble
