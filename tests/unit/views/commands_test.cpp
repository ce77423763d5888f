#include "visual_node/views/commands.hpp"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "common/network_labels.hpp"
#include "netem/profiles/profiles.hpp"

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
    expect_sound(replay_keys());
    for (std::size_t i = 0; i < static_cast<std::size_t>(Command::kCount); ++i) {
        const auto has = [i](std::span<const Key> keys) {
            return std::any_of(keys.begin(), keys.end(),
                               [i](const Key& key) { return static_cast<std::size_t>(key.command) == i; });
        };
        EXPECT_TRUE(has(experimenter_keys()) || has(replay_keys())) << i;
    }
}

TEST(Commands, KeysAreCharactersOfAnyLayout) {
    const auto keys = experimenter_keys();
    EXPECT_EQ(find_command(keys, 'P'), Command::kPause);
    EXPECT_EQ(find_command(keys, '='), Command::kDelayUp);
    EXPECT_EQ(find_command(keys, 'w'), std::nullopt);
    EXPECT_EQ(find_command(keys, 0x20AC), std::nullopt);
    EXPECT_EQ(find_command(keys, 0x100 + 'p'), std::nullopt);
}

TEST(Commands, ModalitiesNetworksAndSpeedsAreInOrder) {
    for (const Modality modality : kModalities) EXPECT_EQ(modality_of(command_of(modality)), modality);
    EXPECT_EQ(modality_of(Command::kNetwork0), std::nullopt);
    EXPECT_STREQ(network_of(Command::kNetwork2)->profile, "paper50");
    EXPECT_EQ(network_of(Command::kNetwork5), &kOfferedNetworks.back());
    EXPECT_EQ(network_of(Command::kVF), nullptr);
    EXPECT_EQ(network_of(Command::kDelayDown), nullptr);
    EXPECT_EQ(speed_of(Command::kSpeed5), 5);
    EXPECT_EQ(speed_of(Command::kToEnd), std::nullopt);
}

TEST(Commands, OfferedNetworksAreProfilesAndEachSaysWhatItIsCalled) {
    for (std::size_t i = 0; i < kOfferedNetworks.size(); ++i) {
        const OfferedNetwork& offered = kOfferedNetworks[i];
        const LinkProfile* profile = built_in_profile(offered.profile);
        ASSERT_NE(profile, nullptr) << offered.profile;
        EXPECT_EQ(to_seconds(profile->down.delay), offered.delay_s) << offered.profile;
        EXPECT_TRUE(NetworkName::of(offered.profile)) << offered.profile;
        const auto command = static_cast<Command>(static_cast<std::size_t>(Command::kNetwork0) + i);
        EXPECT_STREQ(key_of(experimenter_keys(), command).button, offered.profile);
        EXPECT_EQ(network_of(key_of(player_keys(), command).command)->profile, offered.profile);
        EXPECT_STREQ(key_of(player_keys(), command).button, network_label(offered.profile));
    }
}

TEST(Commands, EachNetworkHasPlainWordsOfItsOwn) {
    std::set<std::string_view> all;
    for (const std::string_view profile : profile_names()) {
        ASSERT_NE(network_label(profile), nullptr) << profile;
        EXPECT_TRUE(all.insert(network_label(profile)).second) << profile;
    }
    EXPECT_EQ(all.size(), kNetworkLabels.size());
    EXPECT_EQ(network_label("my/lab.toml"), nullptr);
}

}  // namespace
}  // namespace thimble
