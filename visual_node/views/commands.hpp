// What can be pressed in a view, and the key of each: one list, of which buttons, keyboard and help are made, so that none
// can be without the others. Keys are characters, as the person's own keyboard layout gives them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "common/messages.hpp"

namespace thimble {

enum class Command : std::uint8_t {
    kHF,
    kCF,
    kCCF,
    kVF,
    kPreset0,  // kPreset0 + i: the i-th of kDelayPresets
    kPreset1,
    kPreset2,
    kPreset3,
    kPreset4,
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
    kCount,
};

struct Key {
    Command command;
    char character;      // lower case; what is typed with Shift counts as well
    const char* button;  // what its button says
    const char* help;
};

// Of the experimenter's view, and of the player's panel.
std::span<const Key> experimenter_keys();
std::span<const Key> player_keys();

std::optional<Command> find_command(std::span<const Key> keys, unsigned character);
const Key& key_of(std::span<const Key> keys, Command command);

// Delays by the name of the profile whose mean way back they are (docs/network-profiles.md). An order sets the delay alone:
// jitter and loss stay those of the session file, which the help says.
struct DelayPreset {
    const char* profile;
    double delay_s;
};
inline constexpr std::array<DelayPreset, 5> kDelayPresets{
    {{"ideal", 0}, {"lte", 0.035}, {"paper50", 0.05}, {"4g", 0.085}, {"geo", 0.3}}};

inline constexpr double kDelayStep_s = 0.005;
inline constexpr double kDelayLimit_s = 0.5;

// Of a modality's command or a preset's; none for the others.
std::optional<Modality> modality_of(Command command);
std::optional<double> preset_of_s(Command command);
Command command_of(Modality modality);

}  // namespace thimble
