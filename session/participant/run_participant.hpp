// `thimble run` with a session file that has a table [protocol]: one participant's whole session.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "common/network_settings.hpp"
#include "session/launch/node_starter.hpp"
#include "session/participant/dataset.hpp"
#include "session/participant/participant_session.hpp"
#include "session/run/condition_run.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {

// An experimenter's view of a participant session. Its orders arrive as typed lines.
struct ParticipantView {
    LineSource* lines;             // what it asks; never ends
    std::function<bool()> paused;  // no further trial while it is
    std::function<void(std::size_t trials)> planned;
    MakeObserver make_observer;
};

struct ParticipantRun {
    std::shared_ptr<NodeStarter> starter;  // none: the nodes run already
    std::filesystem::path out;
    NetworkSettings network;
    std::string participant;  // "P07"; empty: as in the session file
    PersonDescription person;
    bool strict_rt = false;
    bool resume = false;
    bool commands = false;  // read them from standard input, also if it is no terminal
    const std::atomic<bool>* stop = nullptr;
    std::optional<ParticipantView> view{};  // of an experimenter
    MakeObserver make_observer{};           // instead of the view's, which it has within it; none: the view's
    // Throws Error (usage) if this machine cannot show a person what the nodes would; may be empty.
    std::function<void()> check_screen{};
};

// Throws Error (usage) if this program would start a real handle for a virtual subject.
void check_virtual_subject(const SystemSettings& settings);

// Throws Error: usage, if participant, order, folder and what was said do not fit together (nothing is
// written then); network, if the nodes cannot be reached; data, if a file of the dataset is damaged.
ParticipantSessionResult run_participant(const SystemSettings& settings, const ParticipantRun& run);

}  // namespace thimble
