// Reports of a SpaceMouse, joystick or gamepad as six axes between -1 and 1. Axes are the device's own:
// of a SpaceMouse x to the right, y towards the person, z down, and turns about them; of a stick x to the right, y
// towards the person.
//
// SpaceMouse reports are told apart by their length, not by the model (spacenavd, PySpaceMouse): number 1 with 6 bytes of
// x, y, z and number 2 with those of rx, ry, rz in turn, or number 1 with all 12; little-endian, full scale 350. Others are
// read as their report descriptor says. Number 3 of a SpaceMouse is a bit per button.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "master/devices/hid/report_descriptor.hpp"

namespace thimble {

inline constexpr std::size_t kHidAxes = 6;  // x, y, z, rx, ry, rz
inline constexpr unsigned kHidButtons = 32;

enum class ReportVerdict : std::uint8_t { kTaken, kOther, kBad };  // kOther: buttons, battery

class HidAxes {
  public:
    static HidAxes of_spacemouse() { return {}; }
    // Those of its first joystick, gamepad or multi-axis controller that has any; nothing if none has.
    static std::optional<HidAxes> described_by(const HidLayout& layout);

    // A bad report changes nothing.
    ReportVerdict take(std::span<const std::uint8_t> report);
    // At rest until the first report.
    const std::array<double, kHidAxes>& values() const { return values_; }
    bool has(std::size_t axis) const { return !layout_ || fields_[axis].bits > 0; }
    // Buttons have the numbers that HID gives them: 1 to kHidButtons. As the newest report that speaks of it says.
    bool pressed(unsigned button) const {
        return button >= 1 && button <= kHidButtons && ((buttons_ >> (button - 1)) & 1U) != 0;
    }
    bool has_button(unsigned button) const;

  private:
    ReportVerdict take_spacemouse(std::span<const std::uint8_t> report);
    ReportVerdict take_described(std::span<const std::uint8_t> report);
    void take_buttons(std::span<const std::uint8_t> report);

    std::array<double, kHidAxes> values_{};
    std::uint32_t buttons_ = 0;
    std::size_t stick_ = 0;            // whose buttons count, of the layout's applications
    std::optional<HidLayout> layout_;  // none: a SpaceMouse
    std::array<HidField, kHidAxes> fields_{};
};

// Devices of the SpaceMouse family by their USB numbers. The vendors' numbers are also on mice and keyboards, so that a
// vendor alone says nothing. From spacenavd's and PySpaceMouse's lists.
struct HidModel {
    std::uint16_t vendor = 0, product = 0;
    std::string_view name;
    bool six_axes = true;  // false: known, and no input for a hand
};

// None: not one of the family.
std::optional<HidModel> find_hid_model(std::uint16_t vendor, std::uint16_t product);

}  // namespace thimble
