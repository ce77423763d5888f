// The output of thimble power: tables, JSON, and a page with curves.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "analysis/report/report.hpp"
#include "analysis/text/html.hpp"
#include "study/power/power.hpp"

namespace thimble {

// A table per delay: subjects needed for each comparison, by trials per modality.
std::vector<ReportTable> power_tables(const PowerResult& result, const PowerOptions& options);
// An object with what was asked, and `comparisons`; null where kMostPowerSubjects are not enough.
nlohmann::ordered_json to_json(const PowerResult& result, const PowerOptions& options);
// Throws Error (usage) if `out` holds a report or an earlier power.json.
void refuse_other_report(const std::filesystem::path& out);
// Writes power.json, report.html and figures/, in place of earlier ones. Throws Error where a file cannot be written.
void write_power_report(const PowerResult& result, const PowerOptions& options, const std::string& command,
                        const Provenance& made_with, const std::filesystem::path& out);

}  // namespace thimble
