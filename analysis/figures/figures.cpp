#include "analysis/figures/figures.hpp"

#include <utility>

#include <fmt/format.h>

#include "common/error.hpp"

namespace thimble {

std::string trials_text(const StudyColumns& columns) {
    std::vector<TrialConditions> conditions;
    for (const TrialRow& row : columns.rows()) conditions.push_back(row.conditions);
    std::string delays;
    for (const double delay_s : delays_of(conditions))
        delays += (delays.empty() ? "" : ", ") + delay_text(delay_s);
    const std::size_t trials = conditions.size(), subjects = columns.subjects().size();
    return fmt::format("{} trial{} of {} subject{} at {} one-way delay.", trials, trials == 1 ? "" : "s",
                       subjects, subjects == 1 ? "" : "s", delays);
}

DrawnFigures draw_figures(std::vector<FigureSource> sources, const std::filesystem::path& output) {
    const std::filesystem::path directory = output / "figures";
    std::erase_if(sources, [](const FigureSource& source) { return source.script.empty(); });
    DrawnFigures drawn;
    if (sources.empty()) return drawn;
    try {
        drawn.problem = draw_with_gnuplot(directory, sources).value_or("");
    } catch (const Error& error) {
        drawn.problem = error.what();
        return drawn;
    }
    for (const FigureSource& source : sources) {
        if (auto svg = drawn_svg(directory, source.name))
            drawn.figures.push_back({source.name, source.title, source.caption, std::move(*svg)});
    }
    return drawn;
}

DrawnFigures draw_figures(const std::vector<TrajectoryPanel>& panels,
                          const std::vector<ConditionSummary>& conditions,
                          const std::filesystem::path& output, const std::string& suffix) {
    std::vector<FigureSource> sources;
    if (!panels.empty()) sources.push_back(trajectory_figure(panels, "trajectories" + suffix));
    if (!conditions.empty()) sources.push_back(bar_figure(conditions, "bars" + suffix));
    return draw_figures(std::move(sources), output);
}

}  // namespace thimble
