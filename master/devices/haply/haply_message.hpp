// Messages of Haply's Inverse Service for an Inverse3: JSON in WebSocket texts. It sends a list of its devices when a client connects, and
// then one state for each message of the client. A command counts once: a service that hears no more lets the device go idle.
//
// Sources of the facts: docs.haply.co/inverseSDK, "WebSocket Protocol" and "Control Commands" of version 3.5; public programs that
// talk to versions 3.1 to 3.4. Metres and newtons in the frame that the service is set to: its base by default, z up.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "master/devices/axis_constraint.hpp"
#include "master/devices/handle_settings.hpp"

namespace thimble {

struct HaplyState {
    DeviceVector position_m{};  // within DeviceMailbox::kReach_m
    bool calibrated = true;     // also where the message has no such word
};

struct HaplyReading {
    std::optional<HaplyState> state{};
    std::string trouble{};  // why there is none
};

// The identifiers of all Inverse3 in a message; empty for what is no message. An identifier has only letters, digits, '-' and '_'.
std::vector<std::string> haply_device_ids(std::string_view message);

HaplyReading read_haply_state(std::string_view message, std::string_view device_id);

// A command of this force, once.
std::string haply_command(std::string_view device_id, HaplyForceKey key, const DeviceVector& force_N);

}  // namespace thimble
