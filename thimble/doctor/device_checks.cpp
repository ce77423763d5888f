#include <algorithm>

#include <fmt/format.h>

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
                        (device.use == DeviceUse::kUnusable ? ", which is no hand's input" : ""));
    }
    return words.empty() ? "none" : fmt::format("{}", fmt::join(words, "; "));
}

// `wanted`: the session does not run, or runs without a hand, if there is none that may be opened.
void judge_devices(const DeviceFacts& facts, const std::vector<Device>& devices, bool wanted,
                   Diagnosis& finding) {
    const auto closed = std::find_if(devices.begin(), devices.end(), [](const Device& device) {
        return device.use != DeviceUse::kUnusable && !device.accessible;
    });
    const bool usable = std::any_of(devices.begin(), devices.end(), [](const Device& device) {
        return device.use != DeviceUse::kUnusable && device.accessible;
    });
    if (closed != devices.end() && !(wanted && usable)) {
        finding.severity = wanted ? Severity::kFault : Severity::kNote;
        finding.says +=
            fmt::format("; {} at {} may not be opened by this user ({})", closed->name, closed->node,
                        facts.rules.empty() ? "no udev rule of Thimble's is installed"
                                            : "log in at this machine's own screen, or plug it in anew");
        finding.remedy = facts.rules.empty() ? kRulesCommand : "sudo udevadm trigger --action=add";
    } else if (wanted && !usable) {
        finding.severity = Severity::kFault;
        finding.says += "; the one that this session asks for is not plugged in";
        finding.remedy = "lsusb";
    }
}

}  // namespace

Diagnosis check_handle(const DeviceFacts& devices, const SessionFacts& session) {
    Diagnosis finding{"handle", Severity::kOk, "", "", ExitCode::kRunFailed};
    const auto use = use_of_handle(session.handle);
    const auto found = devices_for(devices, use, false);
    finding.says = fmt::format("[handle] device = \"{}\"; plugged in: {}", session.handle, list_of(found));
    judge_devices(devices, found, use.has_value(), finding);
    return finding;
}

Diagnosis check_fingertip(const DeviceFacts& devices, const SessionFacts& session) {
    Diagnosis finding{"fingertip", Severity::kOk, "", "", ExitCode::kRunFailed};
    const auto found = devices_for(devices, std::nullopt, true);
    finding.says =
        fmt::format("[cutaneous] device = \"{}\"; boards plugged in: {}", session.fingertip, list_of(found));
    judge_devices(devices, found, session.fingertip == "board", finding);
    return finding;
}

Diagnosis check_can(const CanFacts& can, const KernelFacts& kernel, const SessionFacts& session) {
    Diagnosis finding{"CAN", Severity::kOk, "", "", ExitCode::kRunFailed};
    const bool wanted = session.fingertip == "drives";
    const auto up = std::find_if(can.interfaces.begin(), can.interfaces.end(),
                                 [](const CanFacts::Interface& interface) { return interface.up; });
    if (up != can.interfaces.end()) {
        finding.says = fmt::format("{} is up", up->name);
        if (!wanted || up->queue_frames == 0 || up->queue_frames >= kQueueFrames) return finding;
        finding.severity = Severity::kWarning;
        finding.says += fmt::format(", and {} frames may wait there; twelve drives need {} at once",
                                    up->queue_frames, kQueueFrames);
        finding.remedy = fmt::format("sudo ip link set {} txqueuelen 100", up->name);
        return finding;
    }
    finding.severity = wanted ? Severity::kWarning : Severity::kNote;
    if (!can.interfaces.empty()) {
        finding.says = fmt::format("{} is down", can.interfaces.front().name);
        finding.remedy =
            fmt::format("sudo ip link set {} up type can bitrate 1000000", can.interfaces.front().name);
    } else if (kernel.can) {
        finding.says = "no interface; a fingertip device with CAN drives needs one";
        finding.remedy = "sudo ip link add vcan0 type vcan   # one without hardware, to try";
    } else {
        finding.says =
            "this kernel has none; a fingertip device with CAN drives needs it, or its bus over UDP";
        finding.remedy = "sudo modprobe can_raw";
    }
    return finding;
}

Diagnosis check_screen(const ScreenFacts& screen, bool window_wanted) {
    Diagnosis finding{"OpenGL", Severity::kOk, "", "", ExitCode::kUsage};
    const Severity lacking = window_wanted ? Severity::kFault : Severity::kNote;
    if (!screen.built) {
        finding.severity = lacking;
        finding.says = "this build has no windows (THIMBLE_GUI is off); thimble play needs them";
        finding.remedy = "cmake --preset release -DTHIMBLE_GUI=ON && cmake --build --preset release";
    } else if (!screen.problem.empty()) {
        finding.severity = lacking;
        finding.says = "thimble play and windows: " + screen.problem;
        finding.remedy = screen.problem.rfind("no screen", 0) == 0
                             ? "export DISPLAY=:0   # where this user's desktop runs on this machine"
                             : "sudo apt-get install libgl1-mesa-dri";
    } else {
        finding.says = fmt::format("{}, drawn by {}", screen.version, screen.renderer);
        if (screen.renderer.find("llvmpipe") == std::string::npos) return finding;
        finding.severity = Severity::kWarning;
        finding.says += ": in software, on the processors that the force loop needs";
        finding.remedy = "glxinfo -B   # which driver is used, and why";
    }
    return finding;
}

Diagnosis check_sound(const SoundFacts& sound) {
    Diagnosis finding{"sound", Severity::kOk, "", "", ExitCode::kRunFailed};
    if (sound.built && sound.problem.empty()) {
        finding.says = "a device for the beep was opened";
        return finding;
    }
    finding.severity = Severity::kNote;
    finding.says = sound.built ? "the beep is shown only: " + sound.problem
                               : "this build has no sound (THIMBLE_GUI or THIMBLE_AUDIO is off)";
    finding.remedy = sound.built ? "aplay -l" : "";
    return finding;
}

std::vector<Diagnosis> examine(const Facts& facts) {
    const bool several = facts.session.several_machines;
    return {check_session(facts.session),
            check_programs(facts.programs),
            check_ports(facts.ports),
            check_firewall(facts.firewall, facts.ports, several),
            check_realtime(facts.realtime),
            check_timer(facts.timer, facts.realtime),
            check_governor(facts.processors),
            check_clock_source(facts.processors),
            check_kernel(facts.kernel),
            check_clock(facts.clock, several),
            check_handle(facts.devices, facts.session),
            check_fingertip(facts.devices, facts.session),
            check_can(facts.can, facts.kernel, facts.session),
            check_screen(facts.screen, facts.session.window),
            check_sound(facts.sound),
            check_software(facts.programs)};
}

}  // namespace thimble
