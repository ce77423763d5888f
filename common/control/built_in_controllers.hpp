// Thimble's own compensators behind the interface of plug-ins (<thimble/controller.h>): what a session, a study or a map runs is a
// table in any case.
#pragma once

#include <algorithm>
#include <iterator>
#include <type_traits>

#include "common/control/control_settings.hpp"
#include "common/control/controller.h"
#include "common/error.hpp"

namespace thimble {

// The table of the chosen compensator, the plug-in's too; null for kNone.
const thimble_controller* controller_of(const ControlSettings& settings);
bool has_two_ends(const ControlSettings& settings);
// The values of its keys in the session, in the order of the table.
std::vector<double> values_of(const ControlSettings& settings);

// The built-in tables, a file each.
const thimble_controller& scaled_controller();
const thimble_controller& passivity_controller();
const thimble_controller& memoryless_bound_controller();
const thimble_controller& least_conservative_controller();
const thimble_controller& two_layer_controller();
const thimble_controller& local_fixture_controller();
const thimble_controller& wave_controller();
const thimble_controller& two_port_controller();
const thimble_controller& adaptive_fixture_controller();
const thimble_controller& predicted_share_controller();
const thimble_controller& four_channel_controller();

inline constexpr BuiltInSettings kByDefault{};
// A key that several have.
inline constexpr thimble_controller_key kMostDamping{"most_damping_Ns_per_m",
                                                     kByDefault.most_damping_Ns_per_m, 0, 10000,
                                                     "Most damping that the controller adds; below twice "
                                                     "the moving mass divided by the sample period."};

// A table without its functions.
template <class Keys>
thimble_controller named(const char* name, const char* source, const Keys& keys,
                         std::uint32_t capabilities = 0) {
    thimble_controller table{};
    table.name = name;
    table.source = source;
    table.keys = keys.data();
    table.key_count = static_cast<std::uint32_t>(keys.size());
    table.capabilities = capabilities;
    return table;
}

// The functions of a table, made of a class that is made from settings. Exceptions end at the table, as the interface asks.
template <class End>
struct ControllerFunctions {
    static void* create(const thimble_controller_settings* settings) {
        try {
            return new End(*settings);
        } catch (const Error&) {
            return nullptr;
        }
    }
    static void destroy(void* self) { delete &of(self); }
    static End& of(void* self) { return *static_cast<End*>(self); }
};

// Fills in the handle's end. `End` has start(delay_s), sample(handle, out), force(newest).
template <class End>
thimble_controller with_handle(thimble_controller table) {
    using To = ControllerFunctions<End>;
    table.abi = THIMBLE_CONTROLLER_ABI;
    table.create = To::create;
    table.destroy = To::destroy;
    table.start = [](void* self, double delay_s) { To::of(self).start(delay_s); };
    table.sample = [](void* self, const thimble_handle* handle, thimble_packet* out) {
        To::of(self).sample(*handle, *out);
    };
    table.force = [](void* self, const thimble_feedback* newest) { return To::of(self).force_N(*newest); };
    return table;
}

// `End` has receive(feedback) and forget() as well.
template <class End>
thimble_controller with_memory(thimble_controller table) {
    using To = ControllerFunctions<End>;
    table.receive = [](void* self, const thimble_feedback* feedback) { To::of(self).receive(*feedback); };
    table.forget = [](void* self) { To::of(self).forget(); };
    return table;
}

// The slave's end. `End` has start(), receive(command, packet), step(surroundings), answer(felt, out), hold().
template <class End>
thimble_controller with_slave(thimble_controller table) {
    using To = ControllerFunctions<End>;
    table.capabilities |= THIMBLE_BOTH_ENDS;
    table.create_slave = To::create;
    table.destroy_slave = To::destroy;
    table.start_slave = [](void* self) { To::of(self).start(); };
    table.receive_slave = [](void* self, const thimble_command* command, const thimble_packet* packet) {
        return To::of(self).receive(*command, *packet);
    };
    table.step_slave = [](void* self, const thimble_surroundings* surroundings) {
        return To::of(self).step_m(*surroundings);
    };
    table.answer_slave = [](void* self, const thimble_feedback* felt, thimble_packet* out) {
        To::of(self).answer(*felt, *out);
    };
    table.hold_slave = [](void* self) { To::of(self).hold(); };
    return table;
}

// Of one end: the packets that it hears.
template <class End>
thimble_controller with_packets(thimble_controller table) {
    table.receive_packet = [](void* self, const thimble_packet* packet) {
        ControllerFunctions<End>::of(self).hear(*packet);
    };
    return table;
}

inline thimble_packet packet_of(const WaveBurst& burst) {
    thimble_packet packet{};
    std::copy(burst.wave_root_W.begin(), burst.wave_root_W.end(), std::begin(packet.value));
    packet.sum = burst.sum_root_W_s;
    packet.energy_J = burst.energy_J;
    packet.number = burst.number;
    packet.count = burst.count;
    return packet;
}

inline double limited_N(double force_N, const thimble_controller_settings& settings) {
    return force_N < -settings.force_limit_N  ? -settings.force_limit_N
           : force_N > settings.force_limit_N ? settings.force_limit_N
                                              : force_N;
}

}  // namespace thimble
