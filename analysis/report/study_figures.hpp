// Figures and analysis of a study's report. One gnuplot draws all figures.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <vector>

#include "analysis/analysis.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/report/report.hpp"

namespace thimble {

struct StudyFigures {
    DrawnFigures side_by_side;                          // of a study with more than one experiment
    std::map<std::uint32_t, DrawnFigures> experiments;  // each that has panels
};
// Into OUTPUT/figures; names end in "_experiment1" where there are several. Failure becomes the `problem` of
// those that miss a figure.
StudyFigures draw_study(const std::vector<TrialRow>& rows, const PanelsByExperiment& panels,
                        const std::filesystem::path& output);

// The findings of all experiments, and the figures side by side.
ReportSection overview_section(const std::vector<MeasureAnalysis>& measures, DrawnFigures side_by_side);
// Puts the findings on this experiment before its figures and the tables of the analysis behind its tables.
void add_analysis(ReportSection& section, const std::vector<TrialRow>& rows, std::uint32_t experiment,
                  const std::vector<MeasureAnalysis>& measures);

// Replaces the file; throws Error (run failed) if it cannot be written.
void write_analysis(const std::vector<MeasureAnalysis>& measures, AnalysisKind kind,
                    const std::filesystem::path& json);

}  // namespace thimble
