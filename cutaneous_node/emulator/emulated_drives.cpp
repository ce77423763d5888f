#include "cutaneous_node/emulator/emulated_drives.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "common/decimal_text.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

// More than any pretension, far less than what a trial presses.
constexpr double kPressed_N = 0.2;
constexpr std::uint32_t kErrorBusOff = kCanError | 0x40, kErrorController = kCanError | 0x04;

// Faults without a number.
constexpr std::array<std::pair<std::string_view, void (DriveEmulator::*)()>, 6> kFaults{
    {{"silence", &DriveEmulator::fall_silent},
     {"no-heartbeat", &DriveEmulator::stop_heartbeat},
     {"no-data", &DriveEmulator::stop_data},
     {"short-data", &DriveEmulator::shorten_data},
     {"duplicate", &DriveEmulator::double_itself},
     {"cut", &DriveEmulator::cut_cable}}};

// A drive's reset ends these.
constexpr std::array<std::string_view, 5> kUntilReset{"emcy", "silence", "no-heartbeat", "no-data",
                                                      "short-data"};

// Decimal, or hexadecimal with 0x.
std::optional<std::uint32_t> whole_number(std::string_view text) {
    const bool hexadecimal = text.substr(0, 2) == "0x";
    if (hexadecimal) text.remove_prefix(2);
    return parse_whole<std::uint32_t>(text, hexadecimal ? 16 : 10);
}

// Behind the drive's node; shorter than the words if one is no number.
std::vector<std::uint32_t> numbers_of(const std::vector<std::string_view>& words) {
    std::vector<std::uint32_t> numbers;
    for (std::size_t i = 2; i < words.size(); ++i) {
        if (const auto number = whole_number(words[i])) numbers.push_back(*number);
    }
    return numbers;
}

bool takes(std::string_view what, const std::vector<std::uint32_t>& numbers) {
    constexpr std::uint32_t kMost = 0xffff, kMostSub = 0xff;
    if (what == "emcy") return numbers.size() == 1 && numbers[0] <= kMost;
    if (what == "refuse") {
        return (numbers.size() == 1 || (numbers.size() == 2 && numbers[1] <= kMostSub)) &&
               numbers[0] <= kMost;
    }
    const bool known =
        what == "reboot" ||
        std::any_of(kFaults.begin(), kFaults.end(), [&](const auto& fault) { return fault.first == what; });
    return known && numbers.empty();
}

CanFrame error_frame(std::uint32_t id, std::uint8_t controller) {
    CanFrame frame;
    frame.id = id;
    frame.length = 8;
    frame.data[1] = controller;
    return frame;
}

}  // namespace

EmulatedDrives::EmulatedDrives(const std::vector<std::uint8_t>& nodes, const PlantParameters& plant,
                               CanBus& bus)
    : bus_(&bus) {
    drives_.reserve(nodes.size());
    for (const std::uint8_t node : nodes) drives_.emplace_back(node, plant);
}

void EmulatedDrives::tick(SessionTime now) {
    if (!on_) {
        on_ = true;
        for (DriveEmulator& drive : drives_) {
            if (!off_) drive.reset(now, *bus_);
        }
    }
    CanFrame frame;
    while (bus_->receive(now, frame)) {
        if (off_ || (frame.id & (kCanError | kCanExtended | kCanRemote)) != 0) continue;
        ++frames_;
        for (DriveEmulator& drive : drives_) drive.on_frame(now, frame, *bus_);
    }
    if (!off_) {
        for (DriveEmulator& drive : drives_) drive.tick(now, *bus_);
        look_at_force(now);
    }
    bus_->flush();
}

SessionTime EmulatedDrives::next_wakeup() const {
    if (!on_) return SessionTime{};
    if (off_) return kNever;
    SessionTime next = kNever;
    for (const DriveEmulator& drive : drives_) next = std::min(next, drive.next_wakeup());
    return next;
}

double EmulatedDrives::force_N(std::size_t finger) const {
    double sum_N = 0;
    for (std::size_t i = 0; i < kCablesPerFinger; ++i) sum_N += drives_[3 * finger + i].plant().force_N() / 3;
    return sum_N;
}

void EmulatedDrives::look_at_force(SessionTime now) {
    for (std::size_t finger = 0; finger < drives_.size() / kCablesPerFinger; ++finger) {
        strongest_N_ = std::max(strongest_N_, force_N(finger));
    }
    if (pressed_since_ == kNever && strongest_N_ > kPressed_N) pressed_since_ = now;
    if (pressed_since_ == kNever) return;
    for (Later& later : later_) {
        if (later.words.empty() || now - pressed_since_ < later.after) continue;
        obey(now, later.words);
        later.words.clear();
    }
}

DriveEmulator* EmulatedDrives::find(std::string_view node) {
    const auto number = whole_number(node);
    const auto found = std::find_if(drives_.begin(), drives_.end(),
                                    [&](const DriveEmulator& drive) { return drive.node() == number; });
    return found == drives_.end() ? nullptr : &*found;
}

std::string EmulatedDrives::wrong_in(std::string_view line) {
    const auto words = words_of(line);
    if (words.empty()) return {};
    if (words[0] == "quit" || words[0] == "bus-off" || words[0] == "bus-passive") return {};
    const bool of_drive = words.size() > 1 && find(words[1]) != nullptr;
    const auto numbers = numbers_of(words);
    if (of_drive && numbers.size() + 2 == words.size() && takes(words[0], numbers)) return {};
    return fmt::format("'{}': unknown command or drive, or a number is missing or too large", line);
}

std::string EmulatedDrives::obey_when_pressed(std::string words, Duration after) {
    std::string wrong = wrong_in(words);
    if (wrong.empty()) later_.push_back({std::move(words), after});
    return wrong;
}

std::string EmulatedDrives::obey(SessionTime now, std::string_view line) {
    if (std::string wrong = wrong_in(line); !wrong.empty()) return wrong;
    const auto words = words_of(line);
    if (words.empty()) return {};
    if (!on_ && std::find(kUntilReset.begin(), kUntilReset.end(), words[0]) != kUntilReset.end())
        return fmt::format("'{}': ends with the drive's reset at the start; use --fault-when-pressed", line);
    if (words[0] == "quit") {
        stopped_ = true;
    } else if (words[0] == "bus-off") {
        bus_->send(error_frame(kErrorBusOff, 0));
        off_ = true;
    } else if (words[0] == "bus-passive") {
        bus_->send(error_frame(kErrorController, 0x10));
    } else {
        obey(now, *find(words[1]), words[0], numbers_of(words));
    }
    bus_->flush();
    return {};
}

void EmulatedDrives::obey(SessionTime now, DriveEmulator& drive, std::string_view what,
                          const std::vector<std::uint32_t>& numbers) {
    if (what == "emcy") return drive.emergency(static_cast<std::uint16_t>(numbers[0]), *bus_);
    if (what == "refuse") {
        const auto sub = static_cast<std::uint8_t>(numbers.size() == 2 ? numbers[1] : 0);
        return drive.refuse({static_cast<std::uint16_t>(numbers[0]), sub}, SdoAbort::kNoObject);
    }
    if (what == "reboot") return drive.reset(now, *bus_);
    for (const auto& [word, happens] : kFaults) {
        if (word == what) (drive.*happens)();
    }
}

}  // namespace thimble
