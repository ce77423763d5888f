// Mean trajectories in rows and columns: of one experiment by delay and modality, of several by modality and experiment.

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "analysis/figures/figure_grid.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/figures/measure_axes.hpp"
#include "analysis/text/gnuplot.hpp"

namespace thimble {
namespace {

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

using Text = std::back_insert_iterator<std::string>;

// Where less than half of the trials have samples, a mean shows who is missing rather than what happens.
std::uint32_t least_trials(const MeanCurve& curve) { return std::max(1U, (curve.trials() + 1) / 2); }

// Blocks in the order of `cells`; gnuplot addresses them by index.
std::string trajectory_data(const std::vector<TrajectoryCell>& cells) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    std::string data;
    for (const TrajectoryCell& cell : cells) {
        const TrajectoryPanel& panel = *cell.panel;
        const MeanCurve& curve = panel.mean.curve();
        data += fmt::format(
            "# {} at {}, n = {}; all in percent\n"
            "# time needle_mean needle_sd surface_mean surface_sd needle_of_one_trial trials\n",
            to_string(panel.modality), delay_text(panel.delay_s), curve.trials());
        for (std::size_t i = 0; i < curve.time_percent.size(); ++i) {
            const CurveStatistics& needle = curve.needle[i];
            const CurveStatistics& surface = curve.surface[i];
            write_cell(data, curve.time_percent[i]);
            write_cell(data, needle.trials > 0 ? needle.mean_percent : kNone);
            write_cell(data, needle.sd_percent());
            write_cell(data, surface.trials > 0 ? surface.mean_percent : kNone);
            write_cell(data, surface.sd_percent());
            write_cell(data, curve.example_needle_percent[i]);
            data += fmt::format("{}\n", needle.trials);
        }
        data += "\n\n";
    }
    return data;
}

struct DepthRange {
    double low_percent = -5;
    double high_percent = 110;

    void include(double value_percent) {
        if (std::isnan(value_percent)) return;
        low_percent = std::min(low_percent, value_percent);
        high_percent = std::max(high_percent, value_percent);
    }
};

// One range for all panels, or they could not be compared; with room for the marks at the top.
DepthRange depth_range(const std::vector<TrajectoryCell>& cells) {
    DepthRange range;
    for (const TrajectoryCell& cell : cells) {
        const MeanCurve& curve = cell.panel->mean.curve();
        for (std::size_t i = 0; i < curve.needle.size(); ++i) {
            range.include(curve.example_needle_percent[i]);
            if (curve.needle[i].trials < least_trials(curve)) continue;
            const double sd_percent = curve.needle[i].sd_percent();
            range.include(curve.needle[i].mean_percent);
            range.include(curve.needle[i].mean_percent + sd_percent);
            range.include(curve.needle[i].mean_percent - sd_percent);
        }
    }
    range.low_percent = 5 * std::floor(range.low_percent / 5);
    range.high_percent = 10 * std::ceil(range.high_percent * 0.112);
    return range;
}

void write_curves(Text out, const std::string& name, std::size_t index, const MeanCurve& curve) {
    fmt::format_to(out, R"(data = "'{name}.tsv' index {index} using 1"
shown(value, trials) = trials >= {least} ? value : NaN
plot @data:(shown($4-$5,$7)):(shown($4+$5,$7)) with filledcurves fillcolor '{surface}' fillstyle transparent solid 0.25 noborder notitle, \
     @data:(shown($2-$3,$7)):(shown($2+$3,$7)) with filledcurves fillcolor '{needle}' fillstyle transparent solid 0.25 noborder notitle, \
     @data:6 with lines linewidth 0.8 linecolor '{example}' notitle, \
     @data:(shown($2,$7)) with lines linewidth 2 linecolor '{needle}' notitle, \
     @data:(shown($4,$7)) with lines linewidth 2 dashtype (9,3) linecolor '{surface}' notitle, \
     100 with lines dashtype (3,3) linewidth 1 linecolor 'black' notitle
)",
                   fmt::arg("name", name), fmt::arg("index", index), fmt::arg("least", least_trials(curve)),
                   fmt::arg("needle", kNeedleOnLight), fmt::arg("surface", kSurfaceOnLight),
                   fmt::arg("example", kGrey));
}

FigureGrid layout(const TrajectoryGrid& of) {
    constexpr int kWidth_px = 1160, kWidest_px = 520;
    FigureGrid grid;
    grid.columns = of.columns;
    grid.rows = of.row_labels.size();
    grid.left_px = 87;
    grid.right_px = 14;
    grid.head_px = 32;
    grid.foot_px = 68;
    grid.between_px = 21;
    grid.beneath_px = 48;
    grid.panel_width_px = std::min(kWidest_px, (kWidth_px - grid.left_px - grid.right_px + grid.between_px) /
                                                       static_cast<int>(of.columns) -
                                                   grid.between_px);
    grid.panel_height_px = of.panel_height_px;
    grid.entries = {
        {fmt::format("with lines linewidth 2 linecolor '{}'", kNeedleOnLight), "needle, mean ± SD"},
        {fmt::format("with lines linewidth 2 dashtype (9,3) linecolor '{}'", kSurfaceOnLight),
         "surface, mean ± SD"},
        {fmt::format("with lines linewidth 0.8 linecolor '{}'", kGrey), "needle, one trial"},
        {"with lines dashtype (3,3) linewidth 1 linecolor 'black'", "virtual fixture"}};
    return grid;
}

// A cell beside which, or below which, there is none bears the numbers of its axis.
bool is_first_of_its_row(const TrajectoryGrid& of, const TrajectoryCell& cell) {
    return std::none_of(of.cells.begin(), of.cells.end(), [&](const TrajectoryCell& other) {
        return other.row == cell.row && other.column < cell.column;
    });
}

bool is_last_of_its_column(const TrajectoryGrid& of, const TrajectoryCell& cell) {
    return std::none_of(of.cells.begin(), of.cells.end(), [&](const TrajectoryCell& other) {
        return other.column == cell.column && other.row > cell.row;
    });
}

void write_axes(Text out, bool left, bool bottom, const std::string& row_label) {
    fmt::format_to(out, "set format y '{}'; set format x '{}'\n", left ? "%g" : "", bottom ? "%g" : "");
    if (left) {
        fmt::format_to(out, "set ylabel \"{{/:Bold {}}}\\ndepth (% of fixture)\" offset -0.3\n", row_label);
    } else {
        fmt::format_to(out, "unset ylabel\n");
    }
    fmt::format_to(out, "{}\n", bottom ? "set xlabel 'time, entry to beep (%)'" : "unset xlabel");
}

void write_shared_axes(Text out, const DepthRange& range) {
    const double span_percent = range.high_percent - range.low_percent;
    fmt::format_to(out, R"(set macros; unset key
set xrange [{}:{}]; set xtics 25
set yrange [{}:{}]; set ytics {:g}
set for [x in "0 100"] arrow from x, graph 0 to x, graph 1 nohead dashtype (2,3) linecolor '#666666' back
set label 1 '{{/*0.85  entry}}' at 0, graph 0.96 left textcolor '#444444'
set label 2 '{{/*0.85 beep }}' at 100, graph 0.96 right textcolor '#444444'
set multiplot
)",
                   kCurveBegin_percent, kCurveEnd_percent, range.low_percent, range.high_percent,
                   span_percent <= 200 ? 25 : nice_step(span_percent, 7));
}

std::string trajectory_script(const TrajectoryGrid& of, const std::string& name) {
    const FigureGrid grid = layout(of);
    std::string script = gnuplot_preamble(name, grid.width_px(), grid.height_px());
    const Text out(script);
    write_shared_axes(out, depth_range(of.cells));
    for (std::size_t i = 0; i < of.cells.size(); ++i) {
        const TrajectoryCell& cell = of.cells[i];
        script += grid.margins(cell.row, cell.column);
        write_axes(out, is_first_of_its_row(of, cell), is_last_of_its_column(of, cell),
                   of.row_labels[cell.row]);
        const MeanCurve& curve = cell.panel->mean.curve();
        fmt::format_to(out, "set title '{{/:Bold {}}}  n = {} trial{}' offset 0,-0.6\n", cell.title,
                       curve.trials(), curve.trials() == 1 ? "" : "s");
        write_curves(out, name, i, curve);
    }
    return script + grid.key() + "unset multiplot\n";
}

std::string trajectory_caption(const std::vector<TrajectoryCell>& cells) {
    std::uint32_t low = ~0U, high = 0, with_beep = 0, without_beep = 0, without_entry = 0;
    for (const TrajectoryCell& cell : cells) {
        const MeanCurve& curve = cell.panel->mean.curve();
        low = std::min(low, curve.trials());
        high = std::max(high, curve.trials());
        with_beep += curve.trials_with_beep;
        without_beep += curve.trials_without_beep;
        without_entry += curve.trials_without_entry;
    }
    return fmt::format(
        "Needle and tissue surface (dashed) in percent of the trial's fixture depth, from tissue entry (0 %) "
        "to the beep (100 %); mean with a band of one standard deviation over n = {} trials per panel. Grey: "
        "the needle of one single trial, because averaging trials of different phase hides an oscillation. "
        "Of all trials {} ended with a beep, {} without (their end counts as 100 %), {} never entered the "
        "tissue and are left out. Means are drawn where at least half of the trials have samples.",
        range_text(std::min(low, high), high), with_beep, without_beep, without_entry);
}

FigureSource trajectory_source(const TrajectoryGrid& grid, const std::string& name,
                               const std::string& title) {
    return {name, title, trajectory_caption(grid.cells), trajectory_data(grid.cells),
            trajectory_script(grid, name)};
}

// Of an experiment that was run with and without delay, the one with.
const TrajectoryPanel* own_panel(const TrajectoryPanels& experiment, Modality modality) {
    const TrajectoryPanel* own = nullptr;
    for (const TrajectoryPanel& panel : experiment.panels()) {
        if (panel.modality != modality) continue;
        if (own == nullptr || panel.delay_s > own->delay_s) own = &panel;
    }
    return own;
}

std::vector<Modality> modalities_in(const std::vector<TrajectoryPanel>& panels) {
    std::vector<Modality> modalities;
    for (const Modality modality : kModalities) {
        if (std::any_of(panels.begin(), panels.end(),
                        [&](const TrajectoryPanel& panel) { return panel.modality == modality; }))
            modalities.push_back(modality);
    }
    return modalities;
}

}  // namespace

FigureSource trajectory_figure(const std::vector<TrajectoryPanel>& panels, const std::string& name) {
    const std::vector<double> delays_s = delays_of(panels);
    TrajectoryGrid grid;
    const std::vector<Modality> modalities = modalities_in(panels);
    grid.columns = modalities.size();
    for (std::size_t row = 0; row < delays_s.size(); ++row) {
        grid.row_labels.push_back(delay_text(delays_s[row]) + " delay");
        for (std::size_t column = 0; column < modalities.size(); ++column) {
            const auto panel = find_condition(panels, modalities[column], delays_s[row]);
            if (panel == panels.end()) continue;
            grid.cells.push_back({row, column, to_string(panel->modality), &*panel});
        }
    }
    return trajectory_source(grid, name, "Trajectories");
}

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

}  // namespace thimble
