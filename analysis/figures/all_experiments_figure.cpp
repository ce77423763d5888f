// The experiments side by side, a column each.
#include <fmt/format.h>

#include "analysis/figures/figure_grid.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/figures/measure_panels.hpp"
#include "analysis/figures/trajectory_grid.hpp"
#include "analysis/text/gnuplot.hpp"

namespace thimble {
namespace {

// Of an experiment that was run with and without delay, the one with.
const TrajectoryPanel* own_panel(const TrajectoryPanels& experiment, Modality modality) {
    const TrajectoryPanel* own = nullptr;
    for (const TrajectoryPanel& panel : experiment.panels()) {
        if (panel.modality != modality) continue;
        if (own == nullptr || panel.delay_s > own->delay_s) own = &panel;
    }
    return own;
}

Metric depth_of(const StudyColumns& columns) {
    return columns.experiment() == 2 ? Metric::kPeakDisplacement : Metric::kPenetrationMax;
}

std::array<Metric, 2> bars_of(const StudyColumns& columns) {
    return {depth_of(columns), Metric::kCompletionTime};
}

// A block per experiment and measure, a line per modality: place, mean, SD.
std::string bar_data(const std::vector<StudyColumns>& experiments) {
    std::string data;
    for (const StudyColumns& columns : experiments) {
        const auto conditions = summarize(columns.rows());
        for (const Metric metric : bars_of(columns)) {
            data +=
                fmt::format("# experiment {}: x, mean, sd of {}\n", columns.experiment(), info(metric).label);
            for (const ConditionSummary& condition : conditions) {
                write_cell(data, static_cast<double>(condition.modality));
                write_shown(data, condition.of(metric).mean, metric);
                write_shown(data, condition.of(metric).sd, metric);
                data.back() = '\n';
            }
            data += "\n\n";
        }
    }
    return data;
}

std::string bar_script(const std::vector<StudyColumns>& experiments, const std::string& name) {
    FigureGrid grid;
    grid.columns = experiments.size();
    grid.rows = 2;
    grid.panel_height_px = 180;
    std::string script = gnuplot_preamble(name, grid.width_px(), grid.height_px());
    script += modality_axis() + "set boxwidth 0.6 absolute; unset key\n";
    script += "set yrange [0:*]; set offsets 0, 0, graph 0.06, 0\nset multiplot\n";
    for (std::size_t i = 0; i < experiments.size(); ++i) {
        for (std::size_t row = 0; row < 2; ++row) {
            script += grid.margins(row, i);
            script += row == 0 ? fmt::format("set title '{{/:Bold Experiment {}}}' offset 0,-0.6\n",
                                             experiments[i].experiment())
                               : "unset title\n";
            script += fmt::format("set ylabel '{}'\n", info(bars_of(experiments[i])[row]).label);
            // Whiskers as arrows with flat heads: error bars come with a point, a white hole in the bar.
            script += fmt::format(
                "plot '{0}.tsv' index {1} using 1:2 with boxes fillstyle solid 0.85 noborder linecolor "
                "'{2}', \\\n"
                "     '' index {1} using 1:($2-$3):(0):(2*$3) with vectors heads size graph 0.02,90 "
                "linewidth 1.4 linecolor 'black'\n",
                name, 2 * i + row, kSkyBlue);
        }
    }
    return script + "unset multiplot\n";
}

}  // namespace

FigureSource all_trajectories_figure(const PanelsByExperiment& experiments, const std::string& name) {
    TrajectoryGrid grid;
    grid.columns = experiments.size();
    grid.panel_height_px = 165;
    for (const Modality modality : kModalities) grid.row_labels.emplace_back(to_string(modality));
    std::size_t column = 0;
    for (const auto& [experiment, panels] : experiments) {
        for (std::size_t row = 0; row < kModalities.size(); ++row) {
            const TrajectoryPanel* panel = own_panel(panels, kModalities[row]);
            if (panel == nullptr) continue;
            grid.cells.push_back({row, column,
                                  fmt::format("Experiment {} ({}), {}", experiment,
                                              delay_text(panel->delay_s), to_string(panel->modality)),
                                  panel});
        }
        ++column;
    }
    return trajectory_source(grid, name, "Trajectories, side by side");
}

FigureSource all_bars_figure(const std::vector<StudyColumns>& experiments, const std::string& name) {
    return {
        name, "Depth and time, side by side",
        "Mean and standard deviation over subjects, whose trials are averaged first. Above: maximum "
        "penetration beyond the fixture; in experiment 2 how far the needle jumps when the fixture vanishes. "
        "Below: time from tissue entry to the beep.",
        bar_data(experiments), bar_script(experiments, name)};
}

}  // namespace thimble
