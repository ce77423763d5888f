// The commands of a view with their keys. Buttons, keyboard and help come from this one list, so that they agree.
// Keys are characters, as the user's own keyboard layout gives them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "common/messages.hpp"

namespace thimble {

enum class Command : std::uint8_t {
    kHF,
    kCF,
    kCCF,
    kVF,
    kNetwork0,  // kNetwork0 + i: the i-th of kOfferedNetworks
    kNetwork1,
    kNetwork2,
    kNetwork3,
    kNetwork4,
    kNetwork5,
    kDelayDown,
    kDelayUp,
    kStart,
    kPause,  // or go on
    kEndTrial,
    kRepeat,
    kExclude,  // asks first
    kYes,
    kNo,
    kHelp,
    // Of a replay.
    kPlayPause,
    kFrameBack,
    kFrameOn,
    kBack,
    kOn,
    kFarBack,
    kFarOn,
    kToBegin,
    kToEnd,
    kSpeed0,  // kSpeed0 + i: the i-th of kReplaySpeeds
    kSpeed1,
    kSpeed2,
    kSpeed3,
    kSpeed4,
    kSpeed5,
    kCount,
};

struct Key {
    Command command;
    char character;      // lower case; what is typed with Shift counts as well. Or one of kLeftKey, ...
    const char* button;  // what its button says
    const char* help;
};

// Keys that type no character.
inline constexpr char kLeftKey = 1, kRightKey = 2, kShiftLeftKey = 3, kShiftRightKey = 4, kHomeKey = 5,
                      kEndKey = 6;
// "Space", "Shift Left"; empty for a character that can be read.
std::string_view special_key_name(char character);

// Of the experimenter's view, of the player's panel, and of the same while a recorded trial is shown.
std::span<const Key> experimenter_keys();
std::span<const Key> player_keys();
std::span<const Key> replay_keys();

std::optional<Command> find_command(std::span<const Key> keys, unsigned character);
const Key& key_of(std::span<const Key> keys, Command command);

// Networks offered in views (docs/network-profiles.md), both ways with jitter and loss. Others feel too similar, or
// are farther than any touch application.
struct OfferedNetwork {
    const char* profile;
    double delay_s;  // of its force path, mean: how a view tells that it holds
};
inline constexpr std::array<OfferedNetwork, 6> kOfferedNetworks{
    {{"ideal", 0}, {"wifi", 0.002}, {"paper50", 0.05}, {"leo", 0.018}, {"lte", 0.035}, {"geo", 0.3}}};

inline constexpr std::array<double, 6> kReplaySpeeds{0.1, 0.25, 0.5, 1, 2, 5};
inline constexpr double kReplayFrame_s = 1.0 / 60, kReplayStep_s = 0.1, kReplayFarStep_s = 1;

inline constexpr double kDelayStep_s = 0.005;
inline constexpr double kDelayLimit_s = 0.5;

// Of a modality's command, a network's, a speed's; none for the others.
std::optional<Modality> modality_of(Command command);
const OfferedNetwork* network_of(Command command);
std::optional<double> speed_of(Command command);
Command command_of(Modality modality);

}  // namespace thimble
