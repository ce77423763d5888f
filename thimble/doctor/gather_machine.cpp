#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <string_view>
#include <sys/utsname.h>
#include <thread>
#include <unistd.h>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/process/child.hpp"
#include "common/text_file.hpp"
#include "cutaneous_node/board/board_reports.hpp"
#include "master/devices/hid/hid_axes.hpp"
#include "master/devices/hid/report_descriptor.hpp"
#include "thimble/doctor/facts.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;

// Link types of /sys/class/net/*/type (ARPHRD_...).
constexpr const char* kCanLink = "280";

// Empty where the system fails to read: an unreadable fact keeps its default.
std::string readable_text(const fs::path& file) {
    try {
        return read_text_file(file);
    } catch (const Error&) {
        return {};
    }
}

std::vector<fs::path> entries_of(const fs::path& folder) {
    std::vector<fs::path> entries;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) entries.push_back(entry.path());
    std::sort(entries.begin(), entries.end());
    return entries;
}

std::string value_of_key(const std::string& text, const std::string& key) {
    const std::size_t at = ("\n" + text).find("\n" + key + "=");
    if (at == std::string::npos) return "";
    const std::size_t start = at + key.size() + 1;
    return text.substr(start, text.find('\n', start) - start);
}

std::uint16_t hex_number(const std::string& text) {
    unsigned number = 0;
    return std::sscanf(text.c_str(), "%x", &number) == 1 ? static_cast<std::uint16_t>(number) : 0;
}

bool may_open(const fs::path& node) { return access(node.c_str(), R_OK | W_OK) == 0; }

std::optional<DeviceFacts::Device> hid_device(const fs::path& root, const fs::path& entry) {
    const std::string event = readable_text(entry / "device/uevent");
    unsigned bus = 0, vendor = 0, product = 0;
    if (std::sscanf(value_of_key(event, "HID_ID").c_str(), "%x:%x:%x", &bus, &vendor, &product) != 3)
        return std::nullopt;
    const std::string bytes = readable_text(entry / "device/report_descriptor");
    const auto layout =
        parse_report_descriptor({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    if (!layout) return std::nullopt;
    DeviceFacts::Device device;
    const auto model =
        find_hid_model(static_cast<std::uint16_t>(vendor), static_cast<std::uint16_t>(product));
    const auto& applications = layout->applications;
    const bool stick = std::any_of(applications.begin(), applications.end(), is_stick);
    if (layout->is({kBoardUsagePage, kBoardUsage})) {
        device.use = DeviceUse::kFingertipBoard;
    } else if (stick && (!model || model->six_axes)) {
        device.use = DeviceUse::kHidHand;
    } else if (!model) {
        return std::nullopt;  // keyboards and mice do not matter here
    }
    const std::string name = model ? std::string(model->name) : value_of_key(event, "HID_NAME");
    device.name = fmt::format("{} ({:04x}:{:04x})", name, vendor, product);
    device.node = "/dev/" + entry.filename().string();
    device.accessible = may_open(root / device.node.substr(1));
    return device;
}

std::optional<DeviceFacts::Device> usb_device(const fs::path& root, const fs::path& entry) {
    const std::uint16_t vendor = hex_number(first_line(entry / "idVendor")),
                        product = hex_number(first_line(entry / "idProduct"));
    DeviceFacts::Device device;
    if (vendor == 0x1451) {
        device.use = DeviceUse::kForceDimension;
    } else if (vendor == 0x0403 && product == 0xcb48) {
        device.use = DeviceUse::kFalcon;
    } else {
        return std::nullopt;
    }
    const std::string name = first_line(entry / "product");
    device.name = fmt::format("{} ({:04x}:{:04x})", name.empty() ? "USB device" : name, vendor, product);
    int bus = 0, number = 0;
    std::sscanf(first_line(entry / "busnum").c_str(), "%d", &bus);
    std::sscanf(first_line(entry / "devnum").c_str(), "%d", &number);
    device.node = fmt::format("/dev/bus/usb/{:03}/{:03}", bus, number);
    device.accessible = may_open(root / device.node.substr(1));
    return device;
}

}  // namespace

ProcessorFacts gather_processors(const fs::path& root) {
    ProcessorFacts facts;
    facts.processors = std::max(1U, std::thread::hardware_concurrency());
    for (const fs::path& processor : entries_of(root / "sys/devices/system/cpu")) {
        const std::string governor = first_line(processor / "cpufreq/scaling_governor");
        auto& known = facts.governors;
        if (!governor.empty() && std::find(known.begin(), known.end(), governor) == known.end())
            known.push_back(governor);
    }
    const fs::path clock = root / "sys/devices/system/clocksource/clocksource0";
    facts.clock_source = first_line(clock / "current_clocksource");
    const std::string sources = first_line(clock / "available_clocksource");
    for (const std::string_view source : words_of(sources)) facts.clock_sources.emplace_back(source);
    return facts;
}

KernelFacts gather_kernel(const fs::path& root) {
    KernelFacts facts;
    utsname names{};
    const bool named = uname(&names) == 0;
    facts.release = named ? names.release : "unknown";
    const std::string version = named ? names.version : "";
    facts.preemption = "no PREEMPT";
    for (const char* kind : {"PREEMPT", "PREEMPT_DYNAMIC", "PREEMPT_RT"})
        if (version.find(kind) != std::string::npos) facts.preemption = kind;
    timespec resolution{};
    if (clock_getres(CLOCK_MONOTONIC, &resolution) == 0)
        facts.timer_resolution_s =
            static_cast<double>(resolution.tv_sec) + 1e-9 * static_cast<double>(resolution.tv_nsec);
    facts.can = fs::exists(root / "proc/net/can");
    facts.hidraw = fs::exists(root / "sys/class/hidraw");
    return facts;
}

CanFacts gather_can(const fs::path& root) {
    CanFacts facts;
    for (const fs::path& interface : entries_of(root / "sys/class/net")) {
        if (first_line(interface / "type") != kCanLink) continue;
        const std::string state = first_line(interface / "operstate");  // of vcan: unknown
        facts.interfaces.push_back({interface.filename().string(), state == "up" || state == "unknown",
                                    std::atoi(first_line(interface / "tx_queue_len").c_str())});
    }
    return facts;
}

FirewallFacts gather_firewall(const fs::path& root) {
    if (value_of_key(readable_text(root / "etc/ufw/ufw.conf"), "ENABLED") == "yes")
        return {FirewallKind::kUfw, ""};
    if (fs::exists(root / "run/firewalld")) return {FirewallKind::kFirewalld, ""};
    if (root != "/") return {};
    try {
        const ProgramResult rules = run_program("nft", {"list", "ruleset"}, ".", "");
        const std::string chain = rules.exit_code == 0 ? dropping_chain(rules.output) : "";
        if (!chain.empty()) return {FirewallKind::kNftables, chain};
    } catch (const Error&) {  // not installed
    }
    return {};
}

DeviceFacts gather_devices(const fs::path& root) {
    DeviceFacts facts;
    for (const fs::path& entry : entries_of(root / "sys/class/hidraw")) {
        if (auto device = hid_device(root, entry)) facts.devices.push_back(std::move(*device));
    }
    for (const fs::path& entry : entries_of(root / "sys/bus/usb/devices")) {
        if (auto device = usb_device(root, entry)) facts.devices.push_back(std::move(*device));
    }
    for (const char* folder : {"etc/udev/rules.d", "usr/lib/udev/rules.d"}) {
        for (const fs::path& rules : entries_of(root / folder)) {
            const std::string name = rules.filename().string();
            if (name.rfind("70-thimble-", 0) == 0) facts.rules.push_back(name);
        }
    }
    return facts;
}

}  // namespace thimble
