#include "common/control/control_settings.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace thimble {
namespace {

struct KeyUse {
    std::string_view key;
    std::vector<Compensator> compensators;
};

std::vector<KeyUse> key_uses() {
    using R = Compensator;
    return {{"share", {R::kScaled}},
            {"device_damping_Ns_per_m", {R::kMemorylessBound, R::kLeastConservative, R::kTwoLayer}},
            {"most_damping_Ns_per_m", {R::kPassivity, R::kTwoPort}},
            {"tank_level_J", {R::kTwoLayer}},
            {"tank_damping_Ns_per_m", {R::kTwoLayer}},
            {"local_stiffness_N_per_m", {R::kLocalFixture}},
            {"local_stiffest_N_per_m", {R::kLocalFixture}},
            {"local_memory_samples", {R::kLocalFixture}},
            {"local_shift_m_per_s", {R::kLocalFixture}},
            {"wave_impedance_Ns_per_m", {R::kWave}},
            {"wave_slave_damping_Ns_per_m", {R::kWave}},
            {"wave_reconstruction", {R::kWave}},
            {"wave_repeats", {R::kWave}},
            {"wave_jitter_s", {R::kWave}}};
}

void refuse_keys_of_others(const ConfigTable& table, Compensator chosen) {
    for (const KeyUse& use : key_uses()) {
        const bool used =
            std::find(use.compensators.begin(), use.compensators.end(), chosen) != use.compensators.end();
        if (used || !table.has(use.key)) continue;
        std::string names;
        for (const Compensator compensator : use.compensators) {
            if (!names.empty()) names += " or ";
            names += kCompensatorNames[static_cast<std::size_t>(compensator)];
        }
        table.fail(use.key, "has no effect with compensator = \"" +
                                std::string(kCompensatorNames[static_cast<std::size_t>(chosen)]) +
                                "\": remove it, or choose " + names);
    }
}

}  // namespace

ControlSettings read_control_settings(const ConfigTable& table) {
    ControlSettings s;
    s.compensator = static_cast<Compensator>(
        table.choice("compensator", 0, {kCompensatorNames.begin(), kCompensatorNames.end()}));
    refuse_keys_of_others(table, s.compensator);
    const auto read = [&table](const char* key, double& value, double low, double high) {
        value = table.number(key, value, low, high);
    };
    read("share", s.share, 0, 1);
    read("device_damping_Ns_per_m", s.device_damping_Ns_per_m, 0, 50);
    read("most_damping_Ns_per_m", s.most_damping_Ns_per_m, 0, 10000);
    read("tank_level_J", s.tank.level_J, 1e-6, 10);
    read("tank_damping_Ns_per_m", s.tank.damping_Ns_per_m, 0, 1000);
    read("local_stiffness_N_per_m", s.local.stiffness_N_per_m, 1, 1e6);
    read("local_stiffest_N_per_m", s.local.stiffest_N_per_m, 1, 1e6);
    read("local_memory_samples", s.local.memory, 1, 1e6);
    read("local_shift_m_per_s", s.local.shift_m_per_s, 1e-4, 10);
    read("wave_impedance_Ns_per_m", s.wave_impedance_Ns_per_m, 0.1, 1000);
    read("wave_slave_damping_Ns_per_m", s.wave_slave_damping_Ns_per_m, 0, 1000);
    s.channel.reconstruction = static_cast<WaveReconstruction>(table.choice(
        "wave_reconstruction", 0, {kWaveReconstructionNames.begin(), kWaveReconstructionNames.end()}));
    s.channel.repeats = static_cast<std::uint32_t>(
        table.integer("wave_repeats", s.channel.repeats, 0, std::int64_t{WaveBurst::kMost} - 1));
    s.jitter = table.seconds("wave_jitter_s", s.jitter, Duration::zero(), std::chrono::seconds{1});
    if (s.local.stiffness_N_per_m > s.local.stiffest_N_per_m)
        table.fail("local_stiffest_N_per_m", "must be at least local_stiffness_N_per_m");
    return s;
}

}  // namespace thimble
