// The report of a study (virtual time), of a run (real processes or virtual time) or of both: one HTML file
// that stands alone, and the same numbers as summary.json.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/figures/figures.hpp"
#include "analysis/findings.hpp"
#include "analysis/text/html.hpp"
#include "session/records/condition_summary.hpp"
#include "session/records/trial_table.hpp"

namespace thimble {

// Every part may be empty and is then left out.
struct ReportSection {
    std::string title;
    std::string text;
    std::vector<std::string> findings;         // a paragraph each
    std::vector<ConditionSummary> conditions;  // for summary.json; the tables hold them for people
    DrawnFigures drawn;
    std::vector<ReportTable> tables;
};

struct Answer {
    std::string of;  // "Virtual study", "Real processes", "Virtual time" (of a run); empty if there is one
    std::vector<std::string> sentences;
};

// The clock that the trials ran by, and how long they took.
struct RunTime {
    std::string clock;
    double simulated_s = 0;  // of the session's clock, all trials together
    double wall_s = 0;
};

// Names and values. A value of several lines, such as a session file, is folded in the page.
using Provenance = std::vector<std::pair<std::string, std::string>>;

// With an answer the page has it first, then a legend of the modalities, all figures, and the statistics.
struct ReportInput {
    std::string title;
    std::vector<ReportSection> sections;
    Provenance provenance;  // seed, command, settings, versions
    std::vector<Answer> answers = {};
    std::optional<RunTime> time = {};  // of a run; for summary.json
};

// Figures, and the tables of findings, metrics and movement during the hold.
ReportSection trials_section(std::string title, const std::vector<TrialRow>& rows,
                             const std::vector<GroupFindings>& findings, DrawnFigures drawn);
// Real processes against the same trials (experiment, subject, trial, modality, delay) in virtual time.
ReportSection agreement_section(const std::vector<TrialRow>& real,
                                const std::vector<TrialRow>& in_virtual_time);

// For a report of virtual subjects: names them in title, first line, every caption and the provenance.
void say_virtual_subjects(ReportInput& report);

// Both replace an existing file and throw Error (run failed) if it cannot be written.
void write_report(const ReportInput& report, const std::filesystem::path& html);
void write_summary(const ReportInput& report, const std::filesystem::path& json);

// `thimble report`: one report.html from the folders that a run and a study left behind.

// Reads summary.json and figures/ of each folder; an empty path leaves that part out. Gives their answers. Throws Error: usage if
// both are empty or another command wrote a folder, data if a folder holds no readable results.
std::vector<Answer> write_combined_report(const std::filesystem::path& run,
                                          const std::filesystem::path& study,
                                          const std::filesystem::path& html, const std::string& command);

// Provenance of a study: the paper's sessions whose design it has, words that name none of them where another session has the paper's
// trials, or "user". A run has always the user's.
inline constexpr const char* kDesign = "design";
inline constexpr const char* kUsersDesign = "user";
// As summary.json in this folder says it; nothing if there is none, or of an earlier version.
std::optional<std::string> design_in(const std::filesystem::path& folder);

// Figures of a study's report. One gnuplot draws all figures.
struct StudyFigures {
    DrawnFigures side_by_side;                          // of a study with more than one experiment
    std::map<std::uint32_t, DrawnFigures> experiments;  // each that has panels
};
// Into OUTPUT/figures; names end in "_experiment1" where there are several. Failure becomes the `problem` of
// those that miss a figure.
StudyFigures draw_study(const std::vector<TrialRow>& rows, const PanelsByExperiment& panels,
                        const std::filesystem::path& output);

}  // namespace thimble
