// `thimble report`: one report.html from the folders that a run and a study left behind.
#pragma once

#include <filesystem>
#include <string>

namespace thimble {

// Reads summary.json and figures/ of each folder; an empty path leaves that part out. Throws Error: usage if
// both are empty, data if a folder holds no readable results.
void write_combined_report(const std::filesystem::path& run, const std::filesystem::path& study,
                           const std::filesystem::path& html, const std::string& command);

}  // namespace thimble
