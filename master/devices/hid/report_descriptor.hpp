// A HID device's description of its reports: the bits of each axis in each report. Reads the report descriptor of
// "Device Class Definition for HID 1.11", section 6.2.2, as far as an input needs it: short items, input fields that are
// variables. Offsets count bits from the byte after the report's number.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace thimble {

struct HidUsage {
    std::uint16_t page = 0, usage = 0;
    bool operator==(const HidUsage&) const = default;
};

struct HidField {
    std::uint16_t usage_page = 0, usage = 0;
    std::size_t application = 0;  // which of the layout's; behind its end outside of any
    std::uint8_t report = 0;      // number; 0: reports have none
    std::uint32_t bit_offset = 0, bits = 0;
    std::int32_t minimum = 0, maximum = 0;  // logical, minimum < maximum
};

struct HidLayout {
    // The device's kinds: the usages of its outermost application collections. A receiver is a keyboard, a mouse and a stick, and
    // the X of one is not that of another.
    std::vector<HidUsage> applications;
    bool numbered = false;         // each report begins with its number
    std::vector<HidField> fields;  // input; at most 32 bits each

    bool is(HidUsage usage) const {
        return std::find(applications.begin(), applications.end(), usage) != applications.end();
    }
};

// None if the bytes are no descriptor. Never more than 256 fields, and 16 applications.
std::optional<HidLayout> parse_report_descriptor(std::span<const std::uint8_t> bytes);

// None: another report, or one that is too short for it.
std::optional<std::int32_t> value_of(const HidLayout& layout, const HidField& field,
                                     std::span<const std::uint8_t> report);

inline constexpr std::uint16_t kGenericDesktop = 0x01;
inline constexpr std::uint16_t kMouseUsage = 0x02, kJoystickUsage = 0x04, kGamepadUsage = 0x05,
                               kMultiAxisUsage = 0x08;
// Joystick, gamepad, multi-axis controller: what a hand may hold.
constexpr bool is_stick(HidUsage usage) {
    return usage.page == kGenericDesktop &&
           (usage.usage == kJoystickUsage || usage.usage == kGamepadUsage || usage.usage == kMultiAxisUsage);
}

}  // namespace thimble
