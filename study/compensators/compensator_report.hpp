// The comparison of compensators on one page, and the parts it is made of: figures, findings, and the loops themselves.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/figures/figures.hpp"
#include "analysis/report/report.hpp"
#include "study/compensators/compensator_study.hpp"

namespace thimble {

// The default of `thimble compensators`: six delays, and 50 ms with jitter, without and with loss.
std::vector<CompensatorNetwork> standard_networks();

// `made_with`: more of the provenance. Writes compensators.csv, compensators.json, report.html, summary.json and
// figures/ below `out`. `trials` are all of the plan. Throws Error (run failed) if a file cannot be written; without
// gnuplot the report says that the figures are missing.
void write_compensator_report(const SystemSettings& settings, const CompensatorStudyOptions& options,
                              const std::vector<CompensatorTrial>& trials, const std::string& command,
                              const Provenance& made_with, const std::filesystem::path& out);

// Every trial completed, none oscillating.
bool is_stable(const CompensatorRow& row);

// A measure of a row, as shown.
struct CompensatorMeasure {
    std::string_view name;   // of files
    std::string_view label;  // for people, with its unit
    int decimals;
    bool logarithmic;
    double (*value)(const CompensatorRow&);  // in that unit
};
const std::vector<CompensatorMeasure>& compensator_measures();

// Of rows without jitter and loss; the others are in the matrix.
std::vector<FigureSource> delay_figures(const std::vector<CompensatorRow>& rows);
FigureSource matrix_figure(const std::vector<CompensatorRow>& rows);

// Conditions and networks in the order of the rows, each once.
std::vector<std::string> conditions_in(const std::vector<CompensatorRow>& rows);
std::vector<CompensatorNetwork> networks_in(const std::vector<CompensatorRow>& rows);
// Null if there is none.
const CompensatorRow* find_row(const std::vector<CompensatorRow>& rows, std::string_view condition,
                               std::string_view network);

// The rows condensed from the trials, all of them. Sentences for people, most important first.
std::vector<std::string> compensator_findings(const std::vector<CompensatorRow>& rows,
                                              const std::vector<CompensatorTrial>& trials);

// Stability map of a firm grip, and for five hands the critical delay by theory and as measured. `jobs` threads (0: one per core)
// for the map. Figures into OUT/figures.
ReportSection handle_loop_section(const std::filesystem::path& out, unsigned jobs);

// At which gain and reaction time a person led by skin or eyes would oscillate: theory, the running loop of the same five hands, and
// the virtual operator's own arm with the lags of these settings.
ReportSection perceptual_loop_section(const SystemSettings& settings, const std::filesystem::path& out);

// Growth per second of the virtual operator's arm, nominal and without dry friction, whose intention follows -L x(t - lag).
double operator_growth_per_s(const SystemSettings& settings, double lag_s, double gain_per_s);

}  // namespace thimble
