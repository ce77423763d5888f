// The files that BIDS asks for beside the tables: the meaning of each column, and a page for readers of the folder.
#pragma once

#include <string>
#include <vector>

#include "session/records/participant.hpp"

namespace thimble {

struct Sidecar {
    const char* file;
    std::string text;
};

// participants.json, task-needle_beh.json, README.md and .bidsignore.
std::vector<Sidecar> sidecars_of(SubjectKind kind, const std::string& name);

}  // namespace thimble
