// Figures as SVG and PDF, drawn by gnuplot. Script and data stay beside each figure, so that `gnuplot -d NAME.gp`
// in that directory draws it again. The data of a figure are pure: the same rows give the same bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "analysis/tables/study_columns.hpp"
#include "analysis/text/gnuplot.hpp"
#include "session/records/condition_summary.hpp"
#include "session/records/mean_trajectory.hpp"

namespace thimble {

struct Figure {
    std::string name;  // NAME.gp, NAME.tsv, NAME.svg, NAME.pdf
    std::string title;
    std::string caption;
    std::string svg;  // the element alone, fit to stand in HTML; ids begin with the name
};

// A panel per delay (rows) and modality (columns, in the paper's order): needle and surface, mean with a band of one SD, over
// subjects.
FigureSource trajectory_figure(const std::vector<TrajectoryPanel>& panels, const std::string& name);
// Average and maximum penetration (peak displacement where the fixture was removed) and completion time per modality and
// delay, mean with one SD over subjects.
FigureSource bar_figure(const std::vector<ConditionSummary>& conditions, const std::string& name);

// The experiments side by side, a column each. Trajectories have a row per modality. Bars show average penetration, the
// depth that the experiment is about (maximum penetration, or peak displacement where the fixture was removed), and the time.
using PanelsByExperiment = std::map<std::uint32_t, TrajectoryPanels>;
FigureSource all_trajectories_figure(const PanelsByExperiment& experiments, const std::string& name);
FigureSource all_bars_figure(const std::vector<StudyColumns>& experiments, const std::string& name);

// Of one experiment, a panel per measure. Every subject's line over the modalities, and the mean:
FigureSource subject_figure(const StudyColumns& columns, const std::vector<Metric>& metrics,
                            const std::string& name);
// every trial as a point beside the box of its modality (quartiles, median, whiskers to 1.5 times the box):
FigureSource distribution_figure(const StudyColumns& columns, const std::vector<Metric>& metrics,
                                 const std::string& name);
// the difference of each pair of modalities with the 95 % confidence interval for all pairs of the measure at once, a bare point
// where there are too few subjects. A measure without a pair of two subjects has no panel; no panel at all: an empty script.
FigureSource difference_figure(const StudyColumns& columns, const std::vector<Metric>& metrics,
                               const std::string& name);

// "240 trials of 10 subjects at 50 ms.": what the figures of one experiment are made from.
std::string trials_text(const StudyColumns& columns);

struct DrawnFigures {
    std::vector<Figure> figures;
    std::string problem;  // why there are none, or not all; empty if all is well
};
// Into OUTPUT/figures, all in one gnuplot. A report without pictures is better than none: failure becomes
// `problem`. Sources with an empty script are left out.
DrawnFigures draw_figures(std::vector<FigureSource> sources, const std::filesystem::path& output);
// Trajectories and bars. `suffix` tells the figures of several sections apart ("_real").
DrawnFigures draw_figures(const std::vector<TrajectoryPanel>& panels,
                          const std::vector<ConditionSummary>& conditions,
                          const std::filesystem::path& output, const std::string& suffix = "");

}  // namespace thimble
