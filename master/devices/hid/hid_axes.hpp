// Reports of a SpaceMouse, joystick or gamepad as six axes between -1 and 1. Axes are the device's own:
// of a SpaceMouse x to the right, y towards the person, z down, and turns about them; of a stick x to the right, y
// towards the person.
//
// SpaceMouse reports are told apart by their length, not by the model (spacenavd, PySpaceMouse): number 1 with 6 bytes of
// x, y, z and number 2 with those of rx, ry, rz in turn, or number 1 with all 12; little-endian, full scale 350. Others are
// read as their report descriptor says. Number 3 of a SpaceMouse is a bit per button.
#pragma once

#include <algorithm>
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
    static std::optional<HidAxes> described_by(const HidLayout& layout) {
        HidAxes axes;
        axes.layout_ = layout;
        std::optional<std::size_t> stick;
        for (const HidField& field : layout.fields) {
            const unsigned axis = static_cast<unsigned>(field.usage) - kFirstAxisUsage;
            if (field.usage_page != kGenericDesktop || axis >= kHidAxes || axes.fields_[axis].bits > 0)
                continue;
            if (field.application >= layout.applications.size() ||
                !is_stick(layout.applications[field.application]))
                continue;
            if (stick.value_or(field.application) != field.application) continue;
            stick = field.application;
            axes.fields_[axis] = field;
        }
        axes.stick_ = stick.value_or(0);
        return stick ? std::optional(axes) : std::nullopt;
    }

    // A bad report changes nothing.
    ReportVerdict take(std::span<const std::uint8_t> report) {
        if (report.empty()) return ReportVerdict::kBad;
        return layout_ ? take_described(report) : take_spacemouse(report);
    }

    // At rest until the first report.
    const std::array<double, kHidAxes>& values() const { return values_; }
    bool has(std::size_t axis) const { return !layout_ || fields_[axis].bits > 0; }
    // State of a button, 1 to kHidButtons as HID numbers them, from the newest report that contains it.
    bool pressed(unsigned button) const {
        return button >= 1 && button <= kHidButtons && ((buttons_ >> (button - 1)) & 1U) != 0;
    }
    bool has_button(unsigned button) const {
        if (!layout_) return button >= 1 && button <= kHidButtons;  // not told
        return std::any_of(layout_->fields.begin(), layout_->fields.end(), [&](const HidField& field) {
            return field.usage_page == kButtonPage && field.application == stick_ && field.usage == button;
        });
    }

  private:
    static constexpr double kFullScale = 350;
    static constexpr int kNonsense = 700;                   // no cap of any model gives twice the full scale
    static constexpr std::uint16_t kFirstAxisUsage = 0x30;  // X; then Y, Z, Rx, Ry, Rz
    static constexpr std::uint8_t kTranslation = 1, kRotation = 2, kButtons = 3;
    static constexpr std::uint16_t kButtonPage = 0x09;

    ReportVerdict take_spacemouse(std::span<const std::uint8_t> report) {
        const bool translation = report[0] == kTranslation, rotation = report[0] == kRotation;
        if (report[0] == kButtons) {
            buttons_ = 0;
            for (std::size_t i = 1; i < std::min<std::size_t>(report.size(), 5); ++i)
                buttons_ |= std::uint32_t{report[i]} << (8 * (i - 1));
        }
        if (!translation && !rotation) return ReportVerdict::kOther;
        const std::size_t count = report.size() == 13 && translation ? 6 : 3;
        if (report.size() != 1 + 2 * count) return ReportVerdict::kBad;
        std::array<double, kHidAxes> read{};
        for (std::size_t i = 0; i < count; ++i) {
            const unsigned raw = report[1 + 2 * i] + 256U * report[2 + 2 * i];
            const int value = static_cast<int>(raw) - (raw >= 0x8000 ? 0x10000 : 0);
            if (value < -kNonsense || value > kNonsense) return ReportVerdict::kBad;
            read[i] = std::clamp(value / kFullScale, -1.0, 1.0);
        }
        std::copy_n(read.begin(), count, values_.begin() + (rotation ? 3 : 0));
        return ReportVerdict::kTaken;
    }

    // Rest is the middle of the range. A value outside it is a null state of the standard: the axis keeps its value.
    ReportVerdict take_described(std::span<const std::uint8_t> report) {
        take_buttons(report);
        ReportVerdict verdict = ReportVerdict::kOther;
        for (std::size_t axis = 0; axis < kHidAxes; ++axis) {
            const HidField& field = fields_[axis];
            if (field.bits == 0 || (layout_->numbered && report[0] != field.report)) continue;
            const auto value = value_of(*layout_, field, report);
            if (!value) return ReportVerdict::kBad;  // too short
            if (*value < field.minimum || *value > field.maximum) continue;
            const double low = field.minimum, high = field.maximum;
            values_[axis] = (2.0 * *value - low - high) / (high - low);
            verdict = ReportVerdict::kTaken;
        }
        return verdict;
    }

    // A report that is too short leaves the buttons unchanged.
    void take_buttons(std::span<const std::uint8_t> report) {
        for (const HidField& field : layout_->fields) {
            const bool button = field.usage_page == kButtonPage && field.application == stick_ &&
                                field.usage >= 1 && field.usage <= kHidButtons;
            if (!button || (layout_->numbered && report[0] != field.report)) continue;
            const auto value = value_of(*layout_, field, report);
            if (!value) continue;
            const std::uint32_t bit = std::uint32_t{1} << (field.usage - 1U);
            buttons_ = *value != 0 ? buttons_ | bit : buttons_ & ~bit;
        }
    }

    std::array<double, kHidAxes> values_{};
    std::uint32_t buttons_ = 0;
    std::size_t stick_ = 0;            // whose buttons count, of the layout's applications
    std::optional<HidLayout> layout_;  // none: a SpaceMouse
    std::array<HidField, kHidAxes> fields_{};
};

// Devices of the SpaceMouse family by their USB numbers, and a gamepad that cannot be read. The vendors' numbers are also on
// mice and keyboards, so that a vendor alone says nothing. From spacenavd's and PySpaceMouse's lists.
struct HidModel {
    std::uint16_t vendor = 0, product = 0;
    std::string_view name;
    bool six_axes = true;  // false: known, and no input for a hand
};

// None: not one of the family.
std::optional<HidModel> find_hid_model(std::uint16_t vendor, std::uint16_t product);

}  // namespace thimble
