// Table [control] of a session file: which delay compensator acts at the handle in HF. A key that the chosen
// compensator does not use is refused: it would be without effect. docs/compensators.md.
#pragma once

#include <array>
#include <chrono>
#include <string_view>

#include "common/config.hpp"
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
};
inline constexpr std::array<std::string_view, 9> kCompensatorNames{
    "none",          "scaled", "passivity", "energy-bound-memoryless", "energy-bound", "two-layer",
    "local-fixture", "wave",   "two-port"};

struct ControlSettings {
    Compensator compensator = Compensator::kNone;
    double share = 0.05;                      // kScaled, 0 to 1
    double device_damping_Ns_per_m = 0.5;     // bounds and tank
    double most_damping_Ns_per_m = 250;       // kPassivity, kTwoPort
    TankSettings tank{};                      // kTwoLayer
    LocalFixtureSettings local{};             // kLocalFixture, without sample_period_s
    double wave_slave_damping_Ns_per_m = 20;  // kWave
    double wave_impedance_Ns_per_m = 20;      // kWave
    WaveChannelSettings channel{};            // kWave, without sample_period_s
    Duration jitter =
        std::chrono::milliseconds{2};  // kWave: play-out allows so much beyond the network's delay

    // Of the force for the hand in HF; 1 but for kScaled.
    double hand_share() const { return compensator == Compensator::kScaled ? share : 1; }
};

// Throws Error (usage).
ControlSettings read_control_settings(const ConfigTable& table);

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
