// What BIDS wants beside the tables: what their columns mean, and a page for whoever opens the folder.
#pragma once

#include <filesystem>
#include <string>

#include "experiment/participant.hpp"

namespace thimble {

// participants.json, task-needle_beh.json, README.md and .bidsignore.
void write_sidecars(const std::filesystem::path& folder, SubjectKind kind, const std::string& name);

}  // namespace thimble
