// What `thimble run` takes and does beyond a run of its own when the session file has a [protocol].
#pragma once

#include <string>

#include "session/participant/run_participant.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace thimble {

// --participant, --resume, --consent and what is asked about a person, as said on the command line.
struct ParticipantArguments {
    std::string participant;
    PersonDescription person;
    bool resume = false, commands = false;
};

void add_participant_options(CLI::App& run, ParticipantArguments& arguments);
// Throws Error (usage) if one was given: the session file has no [protocol], or its subject is a person.
void refuse_participant_options(const ParticipantArguments& arguments, const SystemSettings& settings);
// Returns the exit code.
int run_participant_and_say(const SystemSettings& settings, const ParticipantArguments& arguments,
                            ParticipantRun run, bool json);

}  // namespace thimble
