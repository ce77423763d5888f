#include "analysis/figures/trajectory_grid.hpp"

namespace thimble {

FigureSource trajectory_figure(const std::vector<TrajectoryPanel>& panels, const std::string& name) {
    const std::vector<double> delays_s = delays_of(panels);
    TrajectoryGrid grid;
    grid.columns = kModalities.size();
    for (std::size_t row = 0; row < delays_s.size(); ++row) {
        grid.row_labels.push_back(delay_text(delays_s[row]));
        for (std::size_t column = 0; column < kModalities.size(); ++column) {
            const auto panel = find_condition(panels, kModalities[column], delays_s[row]);
            if (panel == panels.end()) continue;
            grid.cells.push_back({row, column, to_string(panel->modality), &*panel});
        }
    }
    return trajectory_source(grid, name, "Trajectories");
}

}  // namespace thimble
