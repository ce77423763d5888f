// Thimble's own compensators as tables: they keep the rules, and their keys are those of [control].
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/control/built_in_controllers.hpp"
#include "common/control/plugin.hpp"

namespace thimble::test {
namespace {

ControlSettings read(const std::string& text) {
    const ConfigFile file = ConfigFile::parse("[control]\n" + text, "session.toml");
    ControlSettings settings;
    file.read_all([&] { settings = read_control_settings(file); });
    return settings;
}

std::string line(const thimble_controller_key& key) {
    if (key.name == std::string("wave_reconstruction")) return "wave_reconstruction = 'play-out'\n";
    return fmt::format("{} = {}\n", key.name,
                       key.fallback == std::floor(key.fallback) ? fmt::format("{:.0f}", key.fallback)
                                                                : fmt::format("{}", key.fallback));
}

TEST(BuiltInTable, KeysAndDefaultsAreThoseOfTheSession) {
    for (std::size_t i = 1; i < kBuiltInCompensators.size(); ++i) {
        ControlSettings settings;
        settings.compensator = static_cast<Compensator>(i);
        const thimble_controller& table = *controller_of(settings);
        EXPECT_EQ(table.name, kBuiltInCompensators[i]);
        EXPECT_EQ(wrong_table(table), "") << table.name;
        std::string text = fmt::format("compensator = '{}'\n", table.name);
        std::vector<double> fallbacks;
        for (std::uint32_t key = 0; key < table.key_count; ++key) {
            text += line(table.keys[key]);
            fallbacks.push_back(table.keys[key].fallback);
        }
        EXPECT_EQ(values_of(settings), fallbacks) << table.name;
        EXPECT_EQ(values_of(read(text)), fallbacks) << table.name;
    }
}

}  // namespace
}  // namespace thimble::test
