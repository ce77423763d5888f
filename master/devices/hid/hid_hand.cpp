#include "master/devices/hid/hid_hand.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace thimble {
namespace {

constexpr std::size_t kLongestReport = 256;
constexpr Duration kOneRead = std::chrono::milliseconds{100};  // the thread can be ended that often
constexpr Duration kLongestPause = std::chrono::milliseconds{100};
constexpr int kStrangeReports = 100;
constexpr std::array<std::string_view, kHidAxes> kAxisNames{"x", "y", "z", "rx", "ry", "rz"};

bool is_hand(const HidDevice& device) {
    const auto model = find_hid_model(device.vendor, device.product);
    return is_stick({device.usage_page, device.usage}) && (!model || model->six_axes);
}

// A device that is known or named in the settings, but has no axis for a hand.
std::string unusable_among(const std::vector<HidDevice>& present, const HidChoice& choice) {
    for (const HidDevice& device : present) {
        const auto model = find_hid_model(device.vendor, device.product);
        const bool named = (choice.vendor != 0 || !choice.serial.empty()) && choice.matches(device);
        if ((named || (model && !model->six_axes)) && !is_hand(device))
            return fmt::format("; {} is not a SpaceMouse, joystick or gamepad that can be read",
                               to_string(device));
    }
    return "";
}

}  // namespace

HidHandSettings read_hid_hand_settings(const ConfigTable& table) {
    HidHandSettings settings;
    settings.device = read_hid_choice(table);
    table.read("axis", settings.axis, kAxisNames, "Axis of the device that moves the hand.");
    table.read("inverted", settings.inverted,
               "false: positive values go into the tissue; true: negative values do.");
    table.read("stop_button", settings.stop_button, 0, kHidButtons,
               "Button for the emergency stop, by its HID number from 1; 0: none.");
    table.read("control", settings.control, {"rate", "position"},
               "rate: deflection is a speed, and the hand stays where it is at rest; position: deflection is "
               "a position, with 0 at rest.");
    table.read("dead_zone_fraction", settings.dead_zone_fraction, 0, 0.9,
               "Dead zone, as a fraction of full deflection; smaller deflections count as 0.");
    table.read("speed_hand_m_per_s", settings.speed_hand_m_per_s, 0.001, 1,
               "rate: speed at full deflection.");
    table.read("travel_hand_m", settings.travel_hand_m, 0.001, 1,
               "position: position at full deflection; rate: farthest position from 0.");
    return settings;
}

std::optional<double> HidHand::deflection() const {
    const double value = deflection_.load(std::memory_order_acquire);
    return value == kAbsent ? std::nullopt : std::optional(value);
}

std::optional<std::size_t> HidHand::choose(const std::vector<HidDevice>& present, std::string& trouble) {
    const auto found = distinct_devices(present, [this](const HidDevice& device) {
        return is_hand(device) && settings_.device.matches(device);
    });
    if (found.size() == 1) return found.front();
    if (found.empty()) {
        trouble =
            "no SpaceMouse, joystick or gamepad to move the needle: plug one in; thimble looks for it once a "
            "second" +
            unusable_among(present, settings_.device);
    } else {
        trouble = fmt::format(
            "two devices could move the needle, {} and {}: name one in [handle.hid] device_id or serial",
            to_string(present[found[0]]), to_string(present[found[1]]));
    }
    return std::nullopt;
}

bool HidHand::attach(const HidDevice& device, std::span<const std::uint8_t> descriptor,
                     std::string& trouble) {
    axes_ = HidAxes::of_spacemouse();
    if (!find_hid_model(device.vendor, device.product)) {
        const auto layout = parse_report_descriptor(descriptor);
        const auto described = layout ? HidAxes::described_by(*layout) : std::nullopt;
        if (!described || !described->has(settings_.axis)) {
            trouble = fmt::format("{} has no axis {}: choose another in [handle.hid] axis", to_string(device),
                                  kAxisNames[settings_.axis]);
            return false;
        }
        axes_ = *described;
    }
    if (settings_.stop_button != 0 && !axes_.has_button(settings_.stop_button)) {
        trouble = fmt::format("{} has no button {}: choose another in [handle.hid] stop_button",
                              to_string(device), settings_.stop_button);
        return false;
    }
    others_ = 0;
    understood_ = find_hid_model(device.vendor, device.product).has_value();
    attachments_.fetch_add(1, std::memory_order_relaxed);
    deflection_.store(0, std::memory_order_release);
    return true;
}

bool HidHand::turn(SessionTime /*now*/, HidLink& link) {
    std::array<std::uint8_t, kLongestReport> report{};
    const int size = link.read(report, kOneRead);
    if (size < 0) return false;
    if (size == 0) return true;
    const ReportVerdict verdict = axes_.take(std::span(report).first(static_cast<std::size_t>(size)));
    note_stop(axes_.pressed(settings_.stop_button));
    switch (verdict) {
        case ReportVerdict::kBad:
            bad_reports_.fetch_add(1, std::memory_order_relaxed);
            break;
        case ReportVerdict::kTaken: {
            understood_ = true;
            const double value = axes_.values()[settings_.axis];
            deflection_.store(settings_.inverted ? -value : value, std::memory_order_release);
            break;
        }
        case ReportVerdict::kOther:
            if (others_ < kStrangeReports) ++others_;
            break;
    }
    return true;
}

std::string_view HidHand::complaint() const {
    if (understood_ || others_ < kStrangeReports) return {};
    return "sends reports without the axes that its descriptor names: connect it by cable";
}

void HidHand::detach() {
    deflection_.store(kAbsent, std::memory_order_release);
    note_stop(false);
}

// Stores the press first, so that no reader misses it.
void HidHand::note_stop(bool down) {
    if (down) stop_pressed_ = true;
    stop_down_ = down;
}

void HidMapping::start(SessionTime now) {
    reached_ = now;
    wanted_m_ = 0;
}

// Maps the deflection beyond the dead zone to 0 to 1, without a jump.
double HidMapping::beyond_dead_zone(double deflection) const {
    const double size = std::fabs(deflection);
    if (size <= settings_.dead_zone_fraction) return 0;
    const double beyond = (size - settings_.dead_zone_fraction) / (1 - settings_.dead_zone_fraction);
    return std::copysign(beyond, deflection);
}

HandInput HidMapping::hand(SessionTime now, std::optional<double> deflection, double position_hand_m,
                           double reach_m) {
    // After a stall the time without steering does not count.
    const double elapsed_s = to_seconds(std::clamp(now - reached_, Duration::zero(), kLongestPause));
    reached_ = now;
    if (!deflection) {
        wanted_m_ = position_hand_m;
        return {wanted_m_, false};
    }
    const double amount = beyond_dead_zone(*deflection);
    if (settings_.control == HidControl::kPosition) return {amount * settings_.travel_hand_m, true};
    wanted_m_ = std::clamp(wanted_m_ + amount * settings_.speed_hand_m_per_s * elapsed_s,
                           position_hand_m - reach_m, position_hand_m + reach_m);
    wanted_m_ = std::clamp(wanted_m_, -settings_.travel_hand_m, settings_.travel_hand_m);
    return {wanted_m_, true};
}

HidHandle::HidHandle(const HandleSettings& handle, const HidHandSettings& settings, HidHand& hand)
    : PointerHandle(handle),
      mapping_(settings),
      hand_(hand),
      reach_m_(handle.coupling.force_limit_N / handle.coupling.stiffness_N_per_m) {}

HandleSample HidHandle::read(SessionTime now) {
    follow(now, mapping_.hand(now, hand_.deflection(), position_hand_m(), reach_m_));
    return PointerHandle::read(now);
}

void HidHandle::start_trial(SessionTime now, const OperatorTask& task) {
    PointerHandle::start_trial(now, task);
    mapping_.start(now);
}

}  // namespace thimble
