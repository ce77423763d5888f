// What BIDS wants beside the tables: what their columns mean, and a page for whoever opens the folder.
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
