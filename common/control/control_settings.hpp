// Table [control] of a session file: which delay compensator acts at the handle in HF. A key that the chosen
// compensator does not use is refused: it would be without effect. docs/compensators.md.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/config.hpp"
#include "common/control/controller.h"
#include "common/control/energy_bound.hpp"
#include "common/control/local_fixture.hpp"
#include "common/control/wave_channel.hpp"

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

// The keys of the built-in ones: their tables take these defaults.
struct BuiltInSettings {
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
};

struct ControlSettings : BuiltInSettings {
    Compensator compensator = Compensator::kNone;
    PluginSettings plugin{};    // kPlugin
    ReadClock clock = nullptr;  // to time a plug-in's calls by; null: in virtual time

    // Of the force for the hand in HF. The skin gets the rest.
    double hand_share() const;
};

// Table [control] of this file. Loads the plug-in that it names, beside the file. Throws Error (usage).
ControlSettings read_control_settings(const ConfigFile& file);

// The keys of [master] that the other end of a compensator needs, too.
template <class Scaling>
void read_scaling(const ConfigTable& master, Scaling& scaling) {
    master.read("position_scale", scaling.position_scale, 0.01, 100,
                "Needle movement divided by hand movement; equal to [operator] position_scale.");
    master.read("force_scale", scaling.force_scale, 0, 100, "Handle force divided by needle force.");
    master.read("force_limit_N", scaling.force_limit_N, 0, 1000,
                "Limit at the handle; the device has its own limit as well.");
    master.read("sample_period_s", scaling.sample_period, 1e-4, 1, "Time between two samples of the handle.");
}

// Loads the user's own controller (controller.h): a shared library, or a Python file, which a child runs.

// With the values that its keys have by default. Throws Error (usage) that names the file and what is wrong with it.
PluginSettings load_plugin(const std::filesystem::path& file);

// A table that breaks the interface's rules: why; empty: none found.
std::string wrong_table(const thimble_controller& table);

// Of the force, for the hand; 1 if the plug-in gives no number within 0 to 1.
double plugin_hand_share(const PluginSettings& plugin);

// A controller in Python: a child runs the file, and each call of the table is a record of fixed size to it and its answer back. As
// deterministic as the file is. Slow: some 20 us a call, so for virtual time and lock-step.

// Asks the file for its name and keys. Throws Error (usage) if it cannot be asked.
const thimble_controller* python_controller(const std::filesystem::path& file);

// A share of the force for the hand, the rest for the skin (the paper's future work; Pacchierotti, Tirmizi, Bianchini
// and Prattichizzo, IROS 2013 and ToH 2015). The loop through the handle has the share's stiffness alone, so a share
// below the critical one is stable. The skin closes no mechanical loop.
//     F_hand = sat(share F),   F_skin = F - share F
// The share comes before the saturation. If it came after, the largest force would be share x limit: a hand that
// pushes harder moves through the fixture, which looks stable at every share.
struct ScaledForce {
    double share = 1;  // 0 to 1

    double hand_N(double force_N, double limit_N) const {
        return std::clamp(share * force_N, -limit_N, limit_N);
    }
    double skin_N(double force_N) const { return (1 - share) * force_N; }
};

}  // namespace thimble
