#include "visual_node/views/commands.hpp"

#include <algorithm>
#include <cassert>

namespace thimble {
namespace {

constexpr std::array kExperimenterKeys{
    Key{Command::kHF, '1', "HF", "next start: force at the handle"},
    Key{Command::kCF, '2', "CF", "next start: on the fingers that act"},
    Key{Command::kCCF, '3', "CCF", "next start: on the other hand's fingers"},
    Key{Command::kVF, '4', "VF", "next start: bar on the screen"},
    Key{Command::kPreset0, '5', "ideal", "delay 0 ms"},
    Key{Command::kPreset1, '6', "lte", "delay 35 ms, as lte"},
    Key{Command::kPreset2, '7', "paper", "delay 50 ms, as paper50"},
    Key{Command::kPreset3, '8', "4g", "delay 85 ms, as 4g"},
    Key{Command::kPreset4, '9', "geo", "delay 300 ms, as geo"},
    Key{Command::kDelayDown, '-', "-5 ms", "less delay; Left arrow too"},
    Key{Command::kDelayUp, '+', "+5 ms", "more delay; Right arrow too"},
    Key{Command::kStart, 's', "Start", "a trial of the chosen modality"},
    Key{Command::kPause, 'p', "Pause", "no further trial, or go on"},
    Key{Command::kEndTrial, 'e', "End trial", "the running one"},
    Key{Command::kRepeat, 'r', "Repeat", "the trial shown, later"},
    Key{Command::kExclude, 'x', "Exclude", "the trial shown; asks first"},
    Key{Command::kYes, 'y', "Yes", "to the question"},
    Key{Command::kNo, 'n', "No", "to the question; Escape too"},
    Key{Command::kHelp, '?', "Keys", "this list"},
};

constexpr std::array kPlayerKeys{
    Key{Command::kHF, '1', "HF", "You feel the force in the handle. With delay it starts to shake."},
    Key{Command::kCF, '2', "CF", "A device presses the fingers you move with. It stays calm."},
    Key{Command::kCCF, '3', "CCF", "The same on your other hand. It stays calm, and feels elsewhere."},
    Key{Command::kVF, '4', "VF", "A bar on the screen shows the force. Calm; watch its length."},
    Key{Command::kPreset0, '5', "ideal", "no delay"},
    Key{Command::kPreset2, '7', "paper", "50 ms, as in the paper"},
    Key{Command::kDelayDown, '-', "-5 ms", "less delay; Left arrow too"},
    Key{Command::kDelayUp, '+', "+5 ms", "more delay; Right arrow too"},
    Key{Command::kStart, ' ', "Again", "a trial of the same modality"},
    Key{Command::kPause, 'p', "Pause", "no further trial, or go on"},
    Key{Command::kEndTrial, 'e', "End", "the running trial"},
    Key{Command::kHelp, '?', "Keys", "this list"},
};

}  // namespace

std::span<const Key> experimenter_keys() { return kExperimenterKeys; }
std::span<const Key> player_keys() { return kPlayerKeys; }

std::optional<Command> find_command(std::span<const Key> keys, unsigned character) {
    if (character >= 'A' && character <= 'Z') character += 'a' - 'A';
    // Where + is not reached without Shift, = lies on its key.
    if (character == '=') character = '+';
    const auto key = std::find_if(keys.begin(), keys.end(), [&](const Key& one) {
        return static_cast<unsigned char>(one.character) == character;
    });
    if (key == keys.end()) return std::nullopt;
    return key->command;
}

const Key& key_of(std::span<const Key> keys, Command command) {
    const auto key =
        std::find_if(keys.begin(), keys.end(), [&](const Key& one) { return one.command == command; });
    assert(key != keys.end());
    return *key;
}

std::optional<Modality> modality_of(Command command) {
    if (command > Command::kVF) return std::nullopt;
    return static_cast<Modality>(command);
}

std::optional<double> preset_of_s(Command command) {
    if (command < Command::kPreset0 || command > Command::kPreset4) return std::nullopt;
    const auto i = static_cast<std::size_t>(command) - static_cast<std::size_t>(Command::kPreset0);
    return kDelayPresets.at(i).delay_s;
}

Command command_of(Modality modality) { return static_cast<Command>(modality); }

}  // namespace thimble
