#include "common/control/control_settings.hpp"

#include "common/control/built_in_controllers.hpp"

namespace thimble {
namespace {

std::span<const thimble_controller_key> keys_of(const thimble_controller& table) {
    return {table.keys, table.key_count};
}

// The name of each key of the built-in tables, and the session's value.
template <class Settings, class Use>
void each_key(Settings& s, Use&& use) {
    use("share", s.share);
    use("device_damping_Ns_per_m", s.device_damping_Ns_per_m);
    use("most_damping_Ns_per_m", s.most_damping_Ns_per_m);
    use("tank_level_J", s.tank.level_J);
    use("tank_damping_Ns_per_m", s.tank.damping_Ns_per_m);
    use("local_stiffness_N_per_m", s.local.stiffness_N_per_m);
    use("local_stiffest_N_per_m", s.local.stiffest_N_per_m);
    use("local_memory_samples", s.local.memory);
    use("local_shift_m_per_s", s.local.shift_m_per_s);
    use("predicted_damping_Ns_per_m", s.predicted_damping_Ns_per_m);
    use("predicted_stiffness_N_per_m", s.predicted_stiffness_N_per_m);
    use("predicted_margin", s.predicted_margin);
    use("coupling_N_per_m", s.coupling_N_per_m);
    use("wave_impedance_Ns_per_m", s.wave_impedance_Ns_per_m);
    use("wave_slave_damping_Ns_per_m", s.wave_slave_damping_Ns_per_m);
    use("wave_reconstruction", s.channel.reconstruction);
    use("wave_repeats", s.channel.repeats);
    use("wave_jitter_s", s.jitter);
}

template <class Value>
double number_of(const Value& value) {
    if constexpr (std::is_same_v<Value, Duration>)
        return to_seconds(value);
    else
        return static_cast<double>(value);
}

template <class Value>
void read_key(const ConfigTable& table, const thimble_controller_key& key, Value& value) {
    if constexpr (std::is_same_v<Value, WaveReconstruction>)
        table.read(key.name, value, kWaveReconstructionNames, key.help);
    else if constexpr (std::is_integral_v<Value>)
        table.read(key.name, value, static_cast<std::int64_t>(key.low), static_cast<std::int64_t>(key.high),
                   key.help);
    else
        table.read(key.name, value, key.low, key.high, key.help);
}

// The built-in tables that have a key of this name.
struct Users {
    std::vector<std::string_view> names;
    const thimble_controller_key* key = nullptr;  // of one of them: they share it
};
Users users_of(std::string_view name) {
    Users users;
    ControlSettings each;
    for (std::size_t i = 1; i < kBuiltInCompensators.size(); ++i) {
        each.compensator = static_cast<Compensator>(i);
        for (const thimble_controller_key& key : keys_of(*controller_of(each))) {
            if (key.name != name) continue;
            users.names.push_back(kBuiltInCompensators[i]);
            users.key = &key;
        }
    }
    return users;
}

// The table's own keys, so that a misspelt one is refused as everywhere.
void read_plugin(const ConfigFile& session, const ConfigTable& table, ControlSettings& s) {
    std::string name;
    table.read("plugin", name,
               "A shared library or a Python file with your own controller, beside this file; used instead "
               "of compensator. Its keys are in [control.plugin_settings].");
    const ConfigTable own = table.table("plugin_settings");
    if (name.empty()) return;
    if (table.has("compensator"))
        table.fail("plugin", "cannot be used together with compensator: remove one of them");
    table.load("plugin", [&] { s.plugin = load_plugin(session.folder() / name); });
    session.uses(name);
    const std::filesystem::path helper =
        std::filesystem::path(name).replace_filename("thimble_controller.py");
    if (name.ends_with(".py") && std::filesystem::exists(session.folder() / helper))
        session.uses(helper.string());
    s.compensator = Compensator::kPlugin;
    const auto keys = keys_of(*s.plugin.table);
    for (std::size_t i = 0; i < keys.size(); ++i)
        own.read(keys[i].name, s.plugin.values[i], keys[i].low, keys[i].high, keys[i].help);
}

}  // namespace

ControlSettings read_control_settings(const ConfigFile& file) {
    const ConfigTable table = file.table("control");
    ControlSettings s;
    table.read("compensator", s.compensator, kBuiltInCompensators,
               "The delay compensator at the handle in HF.");
    read_plugin(file, table, s);
    const std::string_view chosen = kCompensatorNames[static_cast<std::size_t>(s.compensator)];
    each_key(s, [&](std::string_view name, auto& value) {
        const Users users = users_of(name);
        read_key(table.only_with("compensator", chosen, users.names), *users.key, value);
    });
    if (s.local.stiffness_N_per_m > s.local.stiffest_N_per_m)
        table.fail("local_stiffest_N_per_m", "must be at least local_stiffness_N_per_m");
    return s;
}

std::vector<double> values_of(const ControlSettings& settings) {
    if (settings.compensator == Compensator::kPlugin) return settings.plugin.values;
    const thimble_controller* const table = controller_of(settings);
    if (table == nullptr) return {};
    const auto keys = keys_of(*table);
    std::vector<double> values;
    values.reserve(keys.size());
    for (const thimble_controller_key& key : keys) {
        each_key(settings, [&](std::string_view name, const auto& value) {
            if (name == key.name) values.push_back(number_of(value));
        });
    }
    return values;
}

double ControlSettings::hand_share() const {
    if (compensator == Compensator::kScaled) return share;
    if (compensator == Compensator::kPredictedShare) return 0;
    return plugin.table == nullptr ? 1 : plugin_hand_share(plugin);
}

}  // namespace thimble
