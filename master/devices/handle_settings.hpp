// Table [handle] of a session file, and a table for each kind of handle. [A] is an assumption, [P] the paper, [V] a verified source.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/config.hpp"
#include "common/hid/hid_link.hpp"
#include "common/shared_values.hpp"
#include "master/devices/axis_constraint.hpp"
#include "master/devices/falcon/falcon_packet.hpp"
#include "master/operator/limb.hpp"

namespace thimble {

enum class HandleKind : std::uint8_t {
    kSimulated,       // held by the virtual operator (simulated_handle.hpp)
    kPointer,         // drawn by a person's mouse (pointer_handle.hpp)
    kKeyboard,        // the same, by a person's arrow keys
    kHid,             // by a person's SpaceMouse, joystick or gamepad (hid/hid_hand.hpp)
    kForceDimension,  // a real one (docs/handles.md)
    kFalcon,          // a real one
    kRos2,            // a real one that another program reads and drives (remote_handle.hpp)
    kHaply,           // a real one, by its maker's service
    kTouch,           // a real one, by its maker's library
};

// Between a person's pointer and the simulated handle. A pointer is a position that no force can move, so the
// coupling stands for the hand's own softness, and its damper for what keeps a sampled wall passive: K h / 2 <= b
// (Colgate, Stanley and Brown 1995; Colgate and Schenkel 1997), 4.5 Ns/m for the paper's fixture, 9 kN/m at the
// handle and sampled each 1 ms. All is far below the 2 m / h (5 kNs/m) and 4 m / h^2 (100 MN/m) that steps of 0.1 ms bear.
struct CouplingSettings {
    double stiffness_N_per_m = 500;  // [A] between grip and arm of the virtual operator
    double damping_Ns_per_m = 15;    // [A] with the handle's mass 0.7 of critical; three times K h / 2
    // [A] the largest pull of the hand, well below the handle's limit. Otherwise a hand that pushes hard could hold
    // down a late force.
    double force_limit_N = 6;
};

// Table [handle.falcon].
struct FalconSettings {
    AxisSettings axis{2, -1, 0.125};               // towards the base; from the middle of the workspace
    std::string serial;                            // of the USB device; empty: the only one
    std::string firmware;                          // a file; empty: the device must have been loaded already
    std::string firmware_sha256;                   // 64 hexadecimal digits; needed with a file
    double motor_gain_per_Nm = 10000;              // counts for each Nm at a leg [A]; a calibration
    std::uint8_t stop_buttons = kFalconAnyButton;  // of FalconButton: these are emergency stops
    Duration homing_limit = std::chrono::seconds{60};  // for the user, before the node is ready
};

// Table [handle.force_dimension].
struct ForceDimensionSettings {
    AxisSettings axis{0, -1};  // pushing away from the user
    std::string library;       // empty: where DhdLibrary looks
    int serial = 0;            // 0: the only one
    int stop_button = -1;      // which of the SDK's buttons is an emergency stop; -1: none
    bool gravity_compensation = true;
    bool watchdog = true;  // refuse a device whose watchdog cannot be set
};

// [A] small for the first minutes: the maker's pages that we know state no greatest force.
inline constexpr double kHaplyForce_N = 3;

// How a service names a force in its command. Version 3.5's pages say "vector"; public programs for 3.1 to 3.4 say "values".
enum class HaplyForceKey : std::uint8_t { kValues, kVector };

// Table [handle.haply].
struct HaplySettings {
    AxisSettings axis{2, -1, 0.15};  // downwards; from the height of the service's own example
    std::uint16_t port = 10001;      // of this machine
    std::string device_id;           // as the service says it; empty: the only one
    HaplyForceKey force_key = HaplyForceKey::kValues;
};

enum class HidControl : std::uint8_t {
    kRate,      // deflection is a speed; at rest the hand stays where it is
    kPosition,  // deflection is a place; at rest the hand is at 0
};

// Table [handle.hid]: the device that is the hand, and the meaning of its deflection.
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

// [V] of the maker's data sheet: 3.3 N at most, where the arms stand at right angles.
inline constexpr double kTouchForce_N = 3.3;

// Table [handle.touch].
struct TouchSettings {
    AxisSettings axis{2, -1};  // away from the user
    std::string library;       // empty: where HdLibrary looks
    std::string name;          // of the maker's setup program; empty: its default device
    int stop_button = 2;       // 1 is nearer to the tip; 0: none
};

struct HandleSettings {
    double encoder_resolution_m = 1e-5;         // [P] rounded to nearest
    double force_limit_N = kHandleFullScale_N;  // [V] clips, both directions
    HandleMechanics mechanics;
    HandleKind kind = HandleKind::kSimulated;
    CouplingSettings coupling{};  // kPointer, kKeyboard, kHid
    HidHandSettings hid{};
    ForceDimensionSettings force_dimension{};
    FalconSettings falcon{};
    HaplySettings haply{};
    TouchSettings touch{};
};

// True for handles that a person holds. The trial ends when the needle is withdrawn.
constexpr bool held_by_person(HandleKind kind) { return kind != HandleKind::kSimulated; }

// True for handles with motors.
constexpr bool is_real(HandleKind kind) { return kind >= HandleKind::kForceDimension; }

// How long its user may take to make it ready, each time that the master starts: to home a Falcon, to calibrate a Touch, to start a
// ROS 2 driver.
Duration user_limit(const HandleSettings& settings);

// `instead`: of the file's device. Throws Error (usage).
HandleSettings read_handle_settings(const ConfigTable& table, std::optional<HandleKind> instead = {});

}  // namespace thimble
