// participants.tsv: a line per participant, added before the first trial and never altered. Pseudonymous: a
// number and what the study needs; names, dates of birth and the signed consent belong elsewhere.
#pragma once

#include <string>
#include <vector>

#include "session/participant/dataset.hpp"

namespace thimble {

// "n/a" where it was not asked or not told. Values as BIDS wants them.
struct PersonDescription {
    std::string age = "n/a";                // whole years, "89+" from 89 on
    std::string sex = "n/a";                // M, F, O
    std::string handedness = "n/a";         // left, right, ambidextrous
    std::string haptic_experience = "n/a";  // with force-feedback devices: none, some, expert
    bool consent = false;                   // the experimenter says that it was given
};

// "31", or "89+" for 89 and more. Throws Error (usage) for anything but 1 to 120, or "n/a".
std::string age_text(const std::string& years);

// Adds the participant if it is not there. Gives the line that stands in the file if it says something else.
std::string add_participant(const Dataset& dataset, std::uint32_t participant, SubjectKind kind,
                            const PersonDescription& person);

std::vector<std::uint32_t> read_participants(const Dataset& dataset);

}  // namespace thimble
