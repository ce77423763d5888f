#include "experiment/figures.hpp"

#include "common/error.hpp"

namespace thimble {

DrawnFigures draw_figures(const std::vector<TrajectoryPanel>& panels,
                          const std::vector<ConditionSummary>& conditions,
                          const std::filesystem::path& output, const std::string& suffix) {
    DrawnFigures drawn;
    const std::filesystem::path directory = output / "figures";
    try {
        if (!panels.empty()) {
            drawn.figures.push_back(draw_trajectories(panels, directory, "trajectories" + suffix));
        }
        if (!conditions.empty()) drawn.figures.push_back(draw_bars(conditions, directory, "bars" + suffix));
    } catch (const Error& error) {
        drawn.problem = error.what();
    }
    return drawn;
}

}  // namespace thimble
