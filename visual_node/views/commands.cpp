#include "visual_node/views/commands.hpp"

#include <algorithm>
#include <cassert>

#include "common/network_labels.hpp"

namespace thimble {
namespace {

constexpr Key kIdeal{Command::kNetwork0, '5', "ideal", "no delay, no loss"};
constexpr Key kWifi{Command::kNetwork1, '6', "wifi", "force 2 ms late, bursts, 0.2 % lost"};
constexpr Key kPaper{Command::kNetwork2, '7', "paper50", "force 50 ms late, nothing else, as in the paper"};
constexpr Key kLeo{Command::kNetwork3, '8', "leo", "low satellites: 18 ms, jitter, handover every 15 s"};
constexpr Key kLte{Command::kNetwork4, '9', "lte", "35 ms each way, jitter, 0.1 % lost"};
constexpr Key kGeo{Command::kNetwork5, '0', "geo", "300 ms each way by a high satellite, 0.5 % lost"};
constexpr Key kLess{Command::kDelayDown, '-', "-5 ms", "less delay; Left arrow too"};
constexpr Key kMore{Command::kDelayUp, '+', "+5 ms", "more delay; Right arrow too"};
constexpr Key kPauseKey{Command::kPause, 'p', "Pause", "start no further trial; again: continue"};
constexpr Key kHelpKey{Command::kHelp, '?', "Keys", "this list"};

constexpr std::array kExperimenterKeys{
    Key{Command::kHF, '1', "HF", "next trial: force at the handle"},
    Key{Command::kCF, '2', "CF", "next trial: on the acting hand's fingers"},
    Key{Command::kCCF, '3', "CCF", "next trial: on the other hand's fingers"},
    Key{Command::kVF, '4', "VF", "next trial: bar on the screen"},
    kIdeal,
    kWifi,
    kPaper,
    kLeo,
    kLte,
    kGeo,
    kLess,
    kMore,
    Key{Command::kStart, 's', "Start", "start a trial with the chosen modality"},
    kPauseKey,
    Key{Command::kEndTrial, 'e', "End trial", "end the running trial"},
    Key{Command::kRepeat, 'r', "Repeat", "repeat the shown trial later"},
    Key{Command::kExclude, 'x', "Exclude", "exclude the shown trial; asks first"},
    Key{Command::kYes, 'y', "Yes", "answer the question"},
    Key{Command::kNo, 'n', "No", "answer the question; Escape too"},
    kHelpKey,
};

constexpr std::array kPlayerKeys{
    Key{Command::kHF, '1', "Force in the hand",
        "The needle pushes the hand back. With delay it starts to shake."},
    Key{Command::kCF, '2', "On the fingertip",
        "Belts press the fingers that hold the needle. It stays calm."},
    Key{Command::kCCF, '3', "On the other hand", "Belts press the fingers of the other hand. It stays calm."},
    Key{Command::kVF, '4', "As a bar", "A bar shows the force. It stays calm: watch the bar's length."},
    Key{Command::kNetwork0, '5', network_label("ideal"), "no delay, no loss"},
    Key{Command::kNetwork1, '6', network_label("wifi"), "force 2 ms late, bursts, 0.2 % lost"},
    Key{Command::kNetwork2, '7', network_label("paper50"), "force 50 ms late, nothing else, as in the paper"},
    Key{Command::kNetwork3, '8', network_label("leo"), "18 ms, jitter, satellite handover every 15 s"},
    Key{Command::kNetwork4, '9', network_label("lte"), "35 ms each way, jitter, 0.1 % lost"},
    Key{Command::kNetwork5, '0', network_label("geo"), "300 ms each way by a high satellite, 0.5 % lost"},
    kLess,
    kMore,
    Key{Command::kStart, ' ', "Again", "start another trial with the same feel"},
    kPauseKey,
    Key{Command::kEndTrial, 'e', "End", "end this trial"},
    kHelpKey,
};

constexpr std::array kReplayKeys{
    Key{Command::kPlayPause, ' ', "Play", "pause or continue; at the end: play again"},
    Key{Command::kFrameBack, ',', "Frame", "1/60 s back, then pause"},
    Key{Command::kFrameOn, '.', "Frame", "1/60 s forward, then pause"},
    Key{Command::kBack, kLeftKey, "-0.1 s", "0.1 s back"},
    Key{Command::kOn, kRightKey, "+0.1 s", "0.1 s forward"},
    Key{Command::kFarBack, kShiftLeftKey, "-1 s", "1 s back"},
    Key{Command::kFarOn, kShiftRightKey, "+1 s", "1 s forward"},
    Key{Command::kToBegin, kHomeKey, "Begin", "to the start of the trial"},
    Key{Command::kToEnd, kEndKey, "End", "to the end of the trial"},
    Key{Command::kSpeed0, '1', "0.1 x", "slower than recorded"},
    Key{Command::kSpeed1, '2', "0.25 x", "slower than recorded"},
    Key{Command::kSpeed2, '3', "0.5 x", "slower than recorded"},
    Key{Command::kSpeed3, '4', "1 x", "as recorded"},
    Key{Command::kSpeed4, '5', "2 x", "faster than recorded"},
    Key{Command::kSpeed5, '6', "5 x", "faster than recorded"},
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
