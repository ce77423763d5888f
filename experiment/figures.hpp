// Figures as SVG, drawn by gnuplot. Script and data stay beside each figure, so that `gnuplot -d NAME.gp` in
// that directory draws it again.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiment/condition_summary.hpp"
#include "experiment/mean_trajectory.hpp"

namespace thimble {

struct Figure {
    std::string name;  // NAME.gp, NAME.tsv, NAME.svg
    std::string title;
    std::string caption;
    std::string svg;  // the element alone, fit to stand in HTML; ids begin with the name
};

// Both write into `directory` (created if missing) and throw Error (run failed) if gnuplot is missing or
// fails.

// A panel per delay (rows) and modality (columns): needle and surface, mean with a band of one SD, over
// trials.
Figure draw_trajectories(const std::vector<TrajectoryPanel>& panels, const std::filesystem::path& directory,
                         const std::string& name = "trajectories");
// Maximum penetration and completion time per modality and delay, mean with one SD over subjects.
Figure draw_bars(const std::vector<ConditionSummary>& conditions, const std::filesystem::path& directory,
                 const std::string& name = "bars");

struct DrawnFigures {
    std::vector<Figure> figures;
    std::string problem;  // why there are none; empty if all is well
};
// Both figures into OUTPUT/figures. A report without pictures is better than none: failure becomes `problem`.
// `suffix` tells the figures of several sections apart ("_real").
DrawnFigures draw_figures(const std::vector<TrajectoryPanel>& panels,
                          const std::vector<ConditionSummary>& conditions,
                          const std::filesystem::path& output, const std::string& suffix = "");

}  // namespace thimble
