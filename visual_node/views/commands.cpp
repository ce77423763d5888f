#include "visual_node/views/commands.hpp"

#include <algorithm>
#include <cassert>

#include "common/network_words.hpp"

namespace thimble {
namespace {

constexpr Key kIdeal{Command::kNetwork0, '5', "ideal", "no network at all"};
constexpr Key kWifi{Command::kNetwork1, '6', "wifi", "2 ms back, in bursts, 0.2 % lost"};
constexpr Key kPaper{Command::kNetwork2, '7', "paper50", "50 ms back and nothing else, as in the paper"};
constexpr Key kLeo{Command::kNetwork3, '8', "leo", "low satellites: 18 ms, jitter, another one each 15 s"};
constexpr Key kLte{Command::kNetwork4, '9', "lte", "35 ms each way, jitter, 0.1 % lost"};
constexpr Key kGeo{Command::kNetwork5, '0', "geo", "300 ms each way by a high satellite, 0.5 % lost"};
constexpr Key kLess{Command::kDelayDown, '-', "-5 ms", "less delay; Left arrow too"};
constexpr Key kMore{Command::kDelayUp, '+', "+5 ms", "more delay; Right arrow too"};
constexpr Key kPauseKey{Command::kPause, 'p', "Pause", "no further trial, or go on"};
constexpr Key kHelpKey{Command::kHelp, '?', "Keys", "this list"};

constexpr std::array kExperimenterKeys{
    Key{Command::kHF, '1', "HF", "next start: force at the handle"},
    Key{Command::kCF, '2', "CF", "next start: on the fingers that act"},
    Key{Command::kCCF, '3', "CCF", "next start: on the other hand's fingers"},
    Key{Command::kVF, '4', "VF", "next start: bar on the screen"},
    kIdeal,
    kWifi,
    kPaper,
    kLeo,
    kLte,
    kGeo,
    kLess,
    kMore,
    Key{Command::kStart, 's', "Start", "a trial of the chosen modality"},
    kPauseKey,
    Key{Command::kEndTrial, 'e', "End trial", "the running one"},
    Key{Command::kRepeat, 'r', "Repeat", "the trial shown, later"},
    Key{Command::kExclude, 'x', "Exclude", "the trial shown; asks first"},
    Key{Command::kYes, 'y', "Yes", "to the question"},
    Key{Command::kNo, 'n', "No", "to the question; Escape too"},
    kHelpKey,
};

constexpr std::array kPlayerKeys{
    Key{Command::kHF, '1', "Force in the hand",
        "The needle pushes the hand back. With delay it starts to shake."},
    Key{Command::kCF, '2', "On the fingertip",
        "Belts press the fingers that hold the needle. It stays calm."},
    Key{Command::kCCF, '3', "On the other hand", "Belts press the fingers of the other hand. It stays calm."},
    Key{Command::kVF, '4', "As a bar", "A bar shows the force. It stays calm: watch the bar's length."},
    Key{Command::kNetwork0, '5', network_words("ideal"), "no network at all"},
    Key{Command::kNetwork1, '6', network_words("wifi"), "2 ms back, in bursts, 0.2 % lost"},
    Key{Command::kNetwork2, '7', network_words("paper50"), "50 ms back and nothing else, as in the paper"},
    Key{Command::kNetwork3, '8', network_words("leo"), "18 ms, jitter, another satellite each 15 s"},
    Key{Command::kNetwork4, '9', network_words("lte"), "35 ms each way, jitter, 0.1 % lost"},
    Key{Command::kNetwork5, '0', network_words("geo"), "300 ms each way by a high satellite, 0.5 % lost"},
    kLess,
    kMore,
    Key{Command::kStart, ' ', "Again", "another try that feels the same"},
    kPauseKey,
    Key{Command::kEndTrial, 'e', "End", "this try"},
    kHelpKey,
};

constexpr std::array kReplayKeys{
    Key{Command::kPlayPause, ' ', "Play", "stand still, or go on; from the end: once more"},
    Key{Command::kFrameBack, ',', "Frame", "a sixtieth of a second back, and stand still"},
    Key{Command::kFrameOn, '.', "Frame", "a sixtieth of a second on, and stand still"},
    Key{Command::kBack, kLeftKey, "-0.1 s", "a tenth of a second back"},
    Key{Command::kOn, kRightKey, "+0.1 s", "a tenth of a second on"},
    Key{Command::kFarBack, kShiftLeftKey, "-1 s", "a second back"},
    Key{Command::kFarOn, kShiftRightKey, "+1 s", "a second on"},
    Key{Command::kToBegin, kHomeKey, "Begin", "to the trial's begin"},
    Key{Command::kToEnd, kEndKey, "End", "to the trial's end"},
    Key{Command::kSpeed0, '1', "0.1 x", "of the recorded speed"},
    Key{Command::kSpeed1, '2', "0.25 x", "of the recorded speed"},
    Key{Command::kSpeed2, '3', "0.5 x", "of the recorded speed"},
    Key{Command::kSpeed3, '4', "1 x", "as fast as it was"},
    Key{Command::kSpeed4, '5', "2 x", "of the recorded speed"},
    Key{Command::kSpeed5, '6', "5 x", "of the recorded speed"},
    kHelpKey,
};

constexpr std::array<std::string_view, 6> kNamedKeys{"Left",        "Right", "Shift Left",
                                                     "Shift Right", "Home",  "End"};

std::size_t index_after(Command command, Command first) {
    return static_cast<std::size_t>(command) - static_cast<std::size_t>(first);
}

}  // namespace

std::string_view special_key_name(char character) {
    if (character == ' ') return "Space";
    if (character < kLeftKey || character > kEndKey) return {};
    return kNamedKeys.at(static_cast<std::size_t>(character - kLeftKey));
}

std::span<const Key> experimenter_keys() { return kExperimenterKeys; }
std::span<const Key> player_keys() { return kPlayerKeys; }
std::span<const Key> replay_keys() { return kReplayKeys; }

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

const OfferedNetwork* network_of(Command command) {
    if (command < Command::kNetwork0 || command > Command::kNetwork5) return nullptr;
    return &kOfferedNetworks.at(index_after(command, Command::kNetwork0));
}

std::optional<double> speed_of(Command command) {
    if (command < Command::kSpeed0 || command > Command::kSpeed5) return std::nullopt;
    return kReplaySpeeds.at(index_after(command, Command::kSpeed0));
}

Command command_of(Modality modality) { return static_cast<Command>(modality); }

}  // namespace thimble
