#include "common/control/control_settings.hpp"

#include "common/control/built_in_controllers.hpp"
#include "common/control/plugin.hpp"

namespace thimble {
namespace {

// The table's own keys, so that a misspelt one is refused as everywhere.
void read_plugin(const ConfigFile& session, const ConfigTable& table, ControlSettings& s) {
    std::string name;
    table.read(
        "plugin", name,
        "A shared library or a Python file with a controller of your own, beside this file; instead of "
        "compensator. Its keys stand in [control.plugin_settings].");
    const ConfigTable own = table.table("plugin_settings");
    if (name.empty()) return;
    if (table.has("compensator")) table.fail("plugin", "stands beside compensator: leave one of them out");
    table.load("plugin", [&] { s.plugin = load_plugin(session.folder() / name); });
    session.uses(name);
    const std::filesystem::path helper =
        std::filesystem::path(name).replace_filename("thimble_controller.py");
    if (name.ends_with(".py") && std::filesystem::exists(session.folder() / helper))
        session.uses(helper.string());
    s.compensator = Compensator::kPlugin;
    const std::span keys(s.plugin.table->keys, s.plugin.table->key_count);
    for (std::size_t i = 0; i < keys.size(); ++i)
        own.read(keys[i].name, s.plugin.values[i], keys[i].low, keys[i].high, keys[i].help);
}

}  // namespace

ControlSettings read_control_settings(const ConfigFile& file) {
    const ConfigTable table = file.table("control");
    ControlSettings s;
    table.read("compensator", s.compensator, kBuiltInCompensators,
               "Which delay compensator acts at the handle in HF.");
    read_plugin(file, table, s);
    const auto only = [&](std::vector<std::string_view> users) {
        const std::string_view chosen = kCompensatorNames[static_cast<std::size_t>(s.compensator)];
        return table.only_with("compensator", chosen, std::move(users));
    };
    const ConfigTable tank = only({"two-layer"}),
                      local = only({"local-fixture", "adaptive-fixture", "four-channel"}),
                      wave = only({"wave"});
    only({"scaled"})
        .read("share", s.share, 0, 1, "Of the force, for the hand. The rest is pressed on the finger.");
    only({"energy-bound-memoryless", "energy-bound", "two-layer"})
        .read("device_damping_Ns_per_m", s.device_damping_Ns_per_m, 0, 50,
              "Damping that the handle is certain to have.");
    only({"passivity", "two-port"})
        .read("most_damping_Ns_per_m", s.most_damping_Ns_per_m, 0, 10000,
              "The controller's most damping, below twice the moving mass over the sample period.");
    tank.read("tank_level_J", s.tank.level_J, 1e-6, 10, "Energy that the tank aims to hold.");
    tank.read("tank_damping_Ns_per_m", s.tank.damping_Ns_per_m, 0, 1000, "Damping that fills the tank.");
    local.read("local_stiffness_N_per_m", s.local.stiffness_N_per_m, 1, 1e6,
               "At the hand, before it is learnt.");
    local.read("local_stiffest_N_per_m", s.local.stiffest_N_per_m, 1, 1e6,
               "Never stiffer; at least local_stiffness_N_per_m.");
    local.read("local_memory_samples", s.local.memory, 1, 1e6, "Samples after which a contact is forgotten.");
    local.read("local_shift_m_per_s", s.local.shift_m_per_s, 1e-4, 10, "How fast the plane may move.");
    const ConfigTable predicted = only({"predicted-share"});
    predicted.read("predicted_damping_Ns_per_m", s.predicted_damping_Ns_per_m, 0, 1000,
                   "Damping that hand and handle are certain to have.");
    predicted.read("predicted_stiffness_N_per_m", s.predicted_stiffness_N_per_m, 1, 1e6,
                   "Of the fixture at the hand, before it is learnt.");
    predicted.read("predicted_margin", s.predicted_margin, 0, 1, "Of the largest share that is stable.");
    only({"four-channel"})
        .read("coupling_N_per_m", s.coupling_N_per_m, 100, 1e6,
              "How far the needle leaves the hand for a difference of their forces.");
    wave.read("wave_impedance_Ns_per_m", s.wave_impedance_Ns_per_m, 0.1, 1000, "Impedance b of the waves.");
    wave.read("wave_slave_damping_Ns_per_m", s.wave_slave_damping_Ns_per_m, 0, 1000,
              "The slave's own damper.");
    wave.read("wave_reconstruction", s.channel.reconstruction, kWaveReconstructionNames,
              "What stands for waves that are lost or late.");
    wave.read("wave_repeats", s.channel.repeats, 0, std::int64_t{WaveBurst::kMost} - 1,
              "Earlier waves that each packet repeats.");
    wave.read("wave_jitter_s", s.jitter, 0, 1,
              "How much longer than the network's delay the play-out waits.");
    if (s.local.stiffness_N_per_m > s.local.stiffest_N_per_m)
        table.fail("local_stiffest_N_per_m", "must be at least local_stiffness_N_per_m");
    return s;
}

double ControlSettings::hand_share() const {
    if (compensator == Compensator::kScaled) return share;
    if (compensator == Compensator::kPredictedShare) return 0;
    return plugin.table == nullptr ? 1 : plugin_hand_share(plugin);
}

}  // namespace thimble
