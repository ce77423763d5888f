// The comparison of compensators on one page: report.html, and the same numbers as compensators.json and summary.json.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "study/compensators/compensator_study.hpp"

namespace thimble {

// What `thimble compensators` compares unless told otherwise: six delays, and 50 ms with jitter, without and with loss.
std::vector<CompensatorNetwork> standard_networks();

// Writes compensators.csv, compensators.json, report.html, summary.json and figures/ below `out`. `trials` are all of the plan. Throws Error
// (run failed) if a file cannot be written; without gnuplot the report says that the figures are missing.
void write_compensator_report(const SystemSettings& settings, const CompensatorStudyOptions& options,
                              const std::vector<CompensatorTrial>& trials, const std::string& command,
                              const std::filesystem::path& out);

}  // namespace thimble
