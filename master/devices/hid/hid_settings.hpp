// Table [handle.hid]: which device is the hand, and what its deflection means.
#pragma once

#include "common/hid/hid_link.hpp"

namespace thimble {

enum class HidControl : std::uint8_t {
    kRate,      // deflection is a speed; at rest the hand stays where it is
    kPosition,  // deflection is a place; at rest the hand is at 0
};

struct HidHandSettings {
    HidChoice device;
    std::size_t axis = 1;  // of x, y, z, rx, ry, rz: y, towards the person
    bool inverted = false;
    unsigned stop_button = 0;  // an emergency stop, by its HID number from 1; 0: none
    HidControl control = HidControl::kRate;
    double dead_zone_fraction = 0.08;  // of full deflection: at rest no device is quite at rest
    double speed_hand_m_per_s = 0.03;  // kRate: at full deflection
    double travel_hand_m = 0.06;       // kPosition: at full deflection; kRate: no further from 0
};

// Throws Error (usage).
HidHandSettings read_hid_hand_settings(const ConfigTable& table);

}  // namespace thimble
