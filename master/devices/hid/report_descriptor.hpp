// What a HID device says about its own reports: which bits of which report are which axis. Reads the report descriptor of
// "Device Class Definition for HID 1.11", section 6.2.2, as far as an input needs it: short items, input fields that are
// variables. Offsets count bits from the byte after the report's number.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace thimble {

struct HidField {
    std::uint16_t usage_page = 0, usage = 0;
    std::uint8_t report = 0;  // number; 0: reports have none
    std::uint32_t bit_offset = 0, bits = 0;
    std::int32_t minimum = 0, maximum = 0;  // logical, minimum < maximum
};

struct HidLayout {
    std::uint16_t usage_page = 0, usage = 0;  // of the first application collection: what the device is
    bool numbered = false;                    // each report begins with its number
    std::vector<HidField> fields;             // input; at most 32 bits each
};

// None if the bytes are no descriptor. Never more than 256 fields.
std::optional<HidLayout> parse_report_descriptor(std::span<const std::uint8_t> bytes);

// None: another report, or one that is too short for it.
std::optional<std::int32_t> value_of(const HidLayout& layout, const HidField& field,
                                     std::span<const std::uint8_t> report);

inline constexpr std::uint16_t kGenericDesktop = 0x01;
inline constexpr std::uint16_t kMouseUsage = 0x02, kJoystickUsage = 0x04, kGamepadUsage = 0x05,
                               kMultiAxisUsage = 0x08;

}  // namespace thimble
