// Mean trajectories in rows and columns: of one experiment by delay and modality, of several by modality and
// experiment.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "analysis/figures/figure_grid.hpp"
#include "analysis/figures/figures.hpp"

namespace thimble {

struct TrajectoryCell {
    std::size_t row = 0, column = 0;
    std::string title;
    const TrajectoryPanel* panel = nullptr;
};

struct TrajectoryGrid {
    std::size_t columns = 1;
    int panel_height_px = 237;
    std::vector<std::string> row_labels;  // one per row
    std::vector<TrajectoryCell> cells;    // a place without one stays empty
};

FigureSource trajectory_source(const TrajectoryGrid& grid, const std::string& name, const std::string& title);

}  // namespace thimble
