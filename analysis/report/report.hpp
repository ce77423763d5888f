// The report of a study (virtual time), of a run (real processes) or of both: one HTML file that stands
// alone, and the same numbers as summary.json.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/claims/headline.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/text/html.hpp"
#include "session/records/condition_summary.hpp"
#include "session/records/trial_table.hpp"

namespace thimble {

// Every part may be empty and is then left out.
struct ReportSection {
    std::string title;
    std::string text;
    std::vector<std::string> findings;         // a paragraph each
    std::optional<Headline> headline;          // also shown at the top of the report
    std::vector<ConditionSummary> conditions;  // for summary.json; the tables hold them for people
    DrawnFigures drawn;
    std::vector<ReportTable> tables;
};

struct ReportInput {
    std::string title;
    std::vector<ReportSection> sections;
    std::vector<std::pair<std::string, std::string>> provenance;  // seed, command, settings, versions
};

// Headline, figures and the tables of classes, oscillation and metrics.
ReportSection trials_section(std::string title, const std::vector<TrialRow>& rows, DrawnFigures drawn,
                             double headline_delay_s = kHeadlineDelay_s);
// Real processes against the same trials (experiment, subject, trial, modality, delay) in virtual time.
ReportSection agreement_section(const std::vector<TrialRow>& real,
                                const std::vector<TrialRow>& in_virtual_time);

// Both replace an existing file and throw Error (run failed) if it cannot be written.
void write_report(const ReportInput& report, const std::filesystem::path& html);
void write_summary(const ReportInput& report, const std::filesystem::path& json);

// `thimble report`: one report.html from the folders that a run and a study left behind.

// Reads summary.json and figures/ of each folder; an empty path leaves that part out. Throws Error: usage if
// both are empty, data if a folder holds no readable results.
void write_combined_report(const std::filesystem::path& run, const std::filesystem::path& study,
                           const std::filesystem::path& html, const std::string& command);

}  // namespace thimble
