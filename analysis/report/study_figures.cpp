#include <string>
#include <utility>

#include <fmt/format.h>

#include "analysis/report/report.hpp"
#include "session/records/trajectory_file.hpp"

namespace thimble {
namespace {

// The delays that an experiment is about: without delay only where there is nothing else.
std::vector<double> own_delays(const std::vector<TrialRow>& rows) {
    std::vector<double> delays_s = delays_of(rows);
    if (delays_s.size() > 1) std::erase_if(delays_s, [](double delay_s) { return same_delay(delay_s, 0); });
    return delays_s;
}

std::vector<FigureSource> figures_at(const StudyColumns& columns, const std::string& suffix) {
    const std::vector<Metric> metrics = measures_of(columns.experiment());
    return {subject_figure(columns, metrics, "subjects" + suffix),
            distribution_figure(columns, metrics, "distributions" + suffix),
            difference_figure(columns, metrics, "differences" + suffix)};
}

std::vector<FigureSource> figures_of(const std::vector<TrialRow>& rows, std::uint32_t experiment,
                                     const TrajectoryPanels& panels, const std::string& suffix) {
    const std::vector<TrialRow> own = of_experiment(rows, experiment);
    const std::vector<double> delays_s = own_delays(own);
    std::vector<FigureSource> figures{trajectory_figure(panels.panels(), "trajectories" + suffix),
                                      bar_figure(summarize(own), "bars" + suffix)};
    for (const double delay_s : delays_s) {
        const bool alone = delays_s.size() == 1;
        for (FigureSource& figure : figures_at(StudyColumns(rows, experiment, delay_s),
                                               alone ? suffix : suffix + '_' + delay_in_names(delay_s))) {
            if (!alone) figure.title += " at " + delay_text(delay_s);
            figures.push_back(std::move(figure));
        }
    }
    return figures;
}

std::vector<FigureSource> side_by_side(const std::vector<StudyColumns>& columns,
                                       const PanelsByExperiment& panels) {
    return {all_trajectories_figure(panels, "trajectories_all"), all_bars_figure(columns, "bars_all")};
}

// Of all that was drawn, what was drawn from `sources`.
DrawnFigures part_of(const DrawnFigures& drawn, const std::vector<FigureSource>& sources) {
    DrawnFigures part;
    for (const FigureSource& source : sources) {
        if (source.script.empty()) continue;
        bool found = false;
        for (const Figure& figure : drawn.figures) {
            if (figure.name != source.name) continue;
            found = true;
            part.figures.push_back(figure);
        }
        if (!found) part.problem = drawn.problem;
    }
    return part;
}

}  // namespace

StudyFigures draw_study(const std::vector<TrialRow>& rows, const PanelsByExperiment& panels,
                        const std::filesystem::path& output) {
    const bool alone = panels.size() == 1;
    std::vector<StudyColumns> columns;
    std::map<std::uint32_t, std::vector<FigureSource>> sources;
    std::vector<FigureSource> all;
    for (const auto& [experiment, of_experiment] : panels) {
        columns.emplace_back(rows, experiment);
        sources[experiment] = figures_of(rows, experiment, of_experiment,
                                         alone ? "" : fmt::format("_experiment{}", experiment));
        all.insert(all.end(), sources[experiment].begin(), sources[experiment].end());
    }
    const auto together = alone ? std::vector<FigureSource>{} : side_by_side(columns, panels);
    all.insert(all.end(), together.begin(), together.end());

    const DrawnFigures drawn = draw_figures(all, output);
    StudyFigures figures{part_of(drawn, together), {}};
    for (const auto& [experiment, own] : sources) figures.experiments[experiment] = part_of(drawn, own);
    return figures;
}

}  // namespace thimble
