// Devices of the SpaceMouse family by their USB numbers. The vendors' numbers are also on mice and keyboards, so that a
// vendor alone says nothing. From spacenavd's and PySpaceMouse's lists.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace thimble {

struct HidModel {
    std::uint16_t vendor = 0, product = 0;
    std::string_view name;
    bool six_axes = true;  // false: known, and no input for a hand
};

// None: not one of the family.
std::optional<HidModel> find_hid_model(std::uint16_t vendor, std::uint16_t product);

}  // namespace thimble
