#include "visual_node/views/commands.hpp"

#include <set>

#include <gtest/gtest.h>

namespace thimble {
namespace {

void expect_sound(std::span<const Key> keys) {
    std::set<char> characters;
    std::set<Command> commands;
    for (const Key& key : keys) {
        EXPECT_TRUE(characters.insert(key.character).second) << key.button;
        EXPECT_TRUE(commands.insert(key.command).second) << key.button;
        EXPECT_GT(std::string_view(key.help).size(), 5U) << key.button;
        EXPECT_EQ(find_command(keys, static_cast<unsigned char>(key.character)), key.command);
        EXPECT_STREQ(key_of(keys, key.command).button, key.button);
    }
}

TEST(Commands, EveryKeyIsOneCommandsAndEveryCommandHasOne) {
    expect_sound(experimenter_keys());
    expect_sound(player_keys());
    EXPECT_EQ(experimenter_keys().size(), static_cast<std::size_t>(Command::kCount));
}

TEST(Commands, KeysAreCharactersOfAnyLayout) {
    const auto keys = experimenter_keys();
    EXPECT_EQ(find_command(keys, 'P'), Command::kPause);
    EXPECT_EQ(find_command(keys, '='), Command::kDelayUp);
    EXPECT_EQ(find_command(keys, 'w'), std::nullopt);
    EXPECT_EQ(find_command(keys, 0x20AC), std::nullopt);
    EXPECT_EQ(find_command(keys, 0x100 + 'p'), std::nullopt);
}

TEST(Commands, ModalitiesAndPresetsAreInOrder) {
    for (const Modality modality : kModalities) EXPECT_EQ(modality_of(command_of(modality)), modality);
    EXPECT_EQ(modality_of(Command::kPreset0), std::nullopt);
    EXPECT_EQ(preset_of_s(Command::kPreset2), 0.05);
    EXPECT_EQ(preset_of_s(Command::kPreset4), kDelayPresets.back().delay_s);
    EXPECT_EQ(preset_of_s(Command::kVF), std::nullopt);
    EXPECT_EQ(preset_of_s(Command::kDelayDown), std::nullopt);
}

}  // namespace
}  // namespace thimble
