// The comparison of remedies on one page: report.html, and the same numbers as remedies.json and summary.json.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "study/remedies/remedy_study.hpp"

namespace thimble {

// What `thimble remedies` compares unless told otherwise: six delays, and 50 ms with jitter, without and with loss.
std::vector<RemedyNetwork> standard_networks();

// Writes remedies.csv, remedies.json, report.html, summary.json and figures/ below `out`. `trials` are all of the plan. Throws Error
// (run failed) if a file cannot be written; without gnuplot the report says that the figures are missing.
void write_remedy_report(const SystemSettings& settings, const RemedyStudyOptions& options,
                         const std::vector<RemedyTrial>& trials, const std::string& command,
                         const std::filesystem::path& out);

}  // namespace thimble
