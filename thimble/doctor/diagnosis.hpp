// What `thimble doctor` has to say about one thing, in plain words.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/error.hpp"

namespace thimble {

enum class Severity : std::uint8_t {
    kOk,
    kNote,     // something is not there that only other sessions need
    kWarning,  // the session runs, but worse than it could
    kFault,    // the session cannot run
};
const char* to_string(Severity severity);  // "ok", "note", "warning", "fault"

struct Diagnosis {
    std::string name;  // of the check, one or two words
    Severity severity = Severity::kOk;
    std::string says;                      // one sentence
    std::string remedy;                    // one command of a shell that mends it; empty: nothing to mend
    ExitCode code = ExitCode::kRunFailed;  // of the doctor if this is the first fault
    std::vector<std::pair<std::string, double>> values{};  // what was measured, names ending in the unit
};

}  // namespace thimble
