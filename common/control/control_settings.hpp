// Table [control] of a session file: which delay compensator acts at the handle in HF. A key that the chosen
// compensator does not use is refused: it would be without effect. docs/compensators.md.
#pragma once

#include <array>
#include <chrono>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/config.hpp"
#include "common/control/energy_bound.hpp"
#include "common/control/local_fixture.hpp"
#include "common/control/wave_channel.hpp"

struct thimble_controller;  // <thimble/controller.h>

namespace thimble {

enum class Compensator : std::uint8_t {
    kNone,
    kScaled,             // a share of the force for the hand, the rest for the skin
    kPassivity,          // passivity observer and controller
    kMemorylessBound,    // energy bounding
    kLeastConservative,  // the same, with a memory
    kTwoLayer,           // tank
    kLocalFixture,       // model-mediated
    kWave,               // wave variables; needs both sides
    kTwoPort,            // two-port passivity, for comparison; needs both sides
    kAdaptiveFixture,    // a local fixture that trusts a jittering network less
    kPredictedShare,     // a share of the force that the measured delay allows, beside all of it on the skin
    kFourChannel,        // positions and forces both ways, with a model at each end; needs both sides
    kPlugin,             // of the user (docs/howto/controller.md); the last
};
inline constexpr std::array<std::string_view, 13> kCompensatorNames{
    "none",          "scaled", "passivity", "energy-bound-memoryless", "energy-bound",    "two-layer",
    "local-fixture", "wave",   "two-port",  "adaptive-fixture",        "predicted-share", "four-channel",
    "plugin"};
// Those that a session chooses by name.
inline constexpr auto kBuiltInCompensators = std::span(kCompensatorNames).first(kCompensatorNames.size() - 1);

struct PluginSettings {
    std::string file;                           // as it was opened
    const thimble_controller* table = nullptr;  // null: none. It stays loaded until the program ends
    std::vector<double> values;                 // of its keys
};
using ReadClock = SessionTime (*)();

struct ControlSettings {
    Compensator compensator = Compensator::kNone;
    double share = 0.05;                      // kScaled, 0 to 1
    double device_damping_Ns_per_m = 0.5;     // bounds and tank
    double most_damping_Ns_per_m = 250;       // kPassivity, kTwoPort
    TankSettings tank{};                      // kTwoLayer
    LocalFixtureSettings local{};             // kLocalFixture and those made of it, without sample_period_s
    double wave_slave_damping_Ns_per_m = 20;  // kWave
    double wave_impedance_Ns_per_m = 20;      // kWave
    WaveChannelSettings channel{};            // kWave, without sample_period_s
    Duration jitter =
        std::chrono::milliseconds{2};           // kWave: play-out allows so much beyond the network's delay
    double predicted_damping_Ns_per_m = 15;     // kPredictedShare
    double predicted_stiffness_N_per_m = 9000;  // kPredictedShare
    double predicted_margin = 0.8;              // kPredictedShare
    double coupling_N_per_m = 20000;            // kFourChannel
    PluginSettings plugin{};                    // kPlugin
    ReadClock clock = nullptr;                  // to time a plug-in's calls by; null: in virtual time

    // Of the force for the hand in HF. The skin gets the rest.
    double hand_share() const;
};

// Table [control] of this file. Loads the plug-in that it names, beside the file. Throws Error (usage).
ControlSettings read_control_settings(const ConfigFile& file);

// The keys of [master] that the other end of a compensator needs, too.
template <class Scaling>
void read_scaling(const ConfigTable& master, Scaling& scaling) {
    master.read("position_scale", scaling.position_scale, 0.01, 100,
                "Needle per hand; equal to [operator] position_scale.");
    master.read("force_scale", scaling.force_scale, 0, 100, "Handle force per needle force.");
    master.read("force_limit_N", scaling.force_limit_N, 0, 1000,
                "At the handle, before the device's own limit.");
    master.read("sample_period_s", scaling.sample_period, 1e-4, 1, "Between two samples of the handle.");
}

}  // namespace thimble
