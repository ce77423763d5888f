// Table [handle] of a session file: the handle itself, and who moves it.
#pragma once

#include "common/config.hpp"
#include "common/shared_values.hpp"
#include "master/devices/falcon/falcon_settings.hpp"
#include "master/devices/force_dimension/force_dimension_settings.hpp"
#include "master/devices/hid/hid_settings.hpp"
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
};

// Between a person's pointer and the simulated handle. A pointer is a position that no force can move, so the
// coupling stands for the hand's own softness, and its damper for what keeps a sampled wall passive: K h / 2 <= b
// (Colgate, Stanley and Brown 1995; Colgate and Schenkel 1997), 4.5 Ns/m for the paper's fixture, 9 kN/m at the
// handle and sampled each 1 ms. All is far below the 2 m / h (5 kNs/m) and 4 m / h^2 (100 MN/m) that steps of 0.1 ms bear.
struct CouplingSettings {
    double stiffness_N_per_m = 500;  // [A] between grip and arm of the virtual operator
    double damping_Ns_per_m = 15;    // [A] with the handle's mass 0.7 of critical; three times K h / 2
    // [A] the most that the hand pulls with. Clearly less than the handle's limit, or a hand that shoves would hold a late force down.
    double force_limit_N = 6;
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
};

// A person does not say when a trial is over: it ends with the needle withdrawn.
constexpr bool held_by_person(HandleKind kind) { return kind != HandleKind::kSimulated; }

// It has motors of its own.
constexpr bool is_real(HandleKind kind) { return kind >= HandleKind::kForceDimension; }

// How long its user may take to make it ready, each time that the master starts: to home a Falcon, to start a ROS 2 driver.
Duration user_limit(const HandleSettings& settings);

// Throws Error (usage).
HandleSettings read_handle_settings(const ConfigTable& table);

}  // namespace thimble
