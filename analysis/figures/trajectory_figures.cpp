// Mean trajectories in rows and columns: of one experiment by delay and modality, of several by modality and experiment.

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

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
    Modality modality;
    double delay_s;
    MeanCurve curve;
};

TrajectoryCell cell_of(std::size_t row, std::size_t column, std::string title, const TrajectoryPanel& panel) {
    return {row, column, std::move(title), panel.modality, panel.delay_s, panel.mean.curve()};
}

struct TrajectoryGrid {
    std::size_t columns = 1;
    int panel_height_px = 237;
    std::vector<std::string> row_labels;  // one per row
    std::vector<TrajectoryCell> cells;    // a place without one stays empty
};

using Text = std::back_insert_iterator<std::string>;

// Where less than half of the subjects have samples, a mean shows who is missing rather than what happens.
std::uint32_t least_n(const MeanCurve& curve) { return std::max(1U, (curve.n() + 1) / 2); }

bool in_seconds(const MeanCurve& curve) { return curve.grid.axis == CurveAxis::kFromContact; }

std::string n_text(const MeanCurve& curve) {
    const char* unit = curve.subjects > 1 ? "subject" : "trial";
    return fmt::format("n = {} {}{}", curve.n(), unit, curve.n() == 1 ? "" : "s");
}

// Blocks in the order of `cells`; gnuplot addresses them by index.
std::string trajectory_data(const std::vector<TrajectoryCell>& cells) {
    std::string data;
    for (const TrajectoryCell& cell : cells) {
        const MeanCurve& curve = cell.curve;
        data += fmt::format(
            "# {} at {}, {}; time in {}, depth in percent\n"
            "# time needle_mean needle_sd surface_mean surface_sd needle_of_one_trial n\n",
            to_string(cell.modality), delay_text(cell.delay_s), n_text(curve),
            in_seconds(curve) ? "seconds" : "percent");
        for (std::size_t i = 0; i < curve.grid.points; ++i) {
            write_cell(data, curve.grid.at(i));
            for (const CurveStatistics& at : {curve.mean.needle[i], curve.mean.surface[i]}) {
                write_cell(data, at.n > 0 ? at.mean : TrialCurve::kNone);
                write_cell(data, at.sd());
            }
            write_cell(data, curve.example_needle_percent[i]);
            data += fmt::format("{}\n", curve.mean.needle[i].n);
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

bool is_shown(const MeanCurve& curve, std::size_t i) { return curve.mean.needle[i].n >= least_n(curve); }

// One range for all panels, or they could not be compared; with room for the marks at the top.
DepthRange depth_range(const std::vector<TrajectoryCell>& cells) {
    DepthRange range;
    for (const TrajectoryCell& cell : cells) {
        for (std::size_t i = 0; i < cell.curve.grid.points; ++i) {
            range.include(cell.curve.example_needle_percent[i]);
            if (!is_shown(cell.curve, i)) continue;
            const CurveStatistics& needle = cell.curve.mean.needle[i];
            range.include(needle.mean);
            range.include(needle.mean + needle.sd());
            range.include(needle.mean - needle.sd());
        }
    }
    range.low_percent = 5 * std::floor(range.low_percent / 5);
    range.high_percent = 10 * std::ceil(range.high_percent * 0.112);
    return range;
}

// In seconds as long as some mean is shown, else the whole axis.
std::pair<double, double> time_range(const std::vector<TrajectoryCell>& cells) {
    double low = 0, high = 0;
    for (const TrajectoryCell& cell : cells) {
        const CurveGrid& grid = cell.curve.grid;
        if (!in_seconds(cell.curve)) return {grid.begin, grid.end};
        for (std::size_t i = 0; i < grid.points; ++i) {
            if (!is_shown(cell.curve, i)) continue;
            low = std::min(low, std::floor(grid.at(i)));
            high = std::max(high, std::ceil(grid.at(i)));
        }
    }
    return low < high ? std::pair{low, high} : std::pair{-1.0, 1.0};
}

void write_curves(Text out, const std::string& name, std::size_t index, const MeanCurve& curve) {
    fmt::format_to(out, R"(data = "'{name}.tsv' index {index} using 1"
shown(value, n) = n >= {least} ? value : NaN
plot @data:(shown($4-$5,$7)):(shown($4+$5,$7)) with filledcurves fillcolor '{surface}' fillstyle transparent solid 0.25 noborder notitle, \
     @data:(shown($2-$3,$7)):(shown($2+$3,$7)) with filledcurves fillcolor '{needle}' fillstyle transparent solid 0.25 noborder notitle, \
     @data:6 with lines linewidth 0.8 linecolor '{example}' notitle, \
     @data:(shown($2,$7)) with lines linewidth 2 linecolor '{needle}' notitle, \
     @data:(shown($4,$7)) with lines linewidth 2 dashtype (9,3) linecolor '{surface}' notitle, \
     100 with lines dashtype (3,3) linewidth 1 linecolor 'black' notitle
)",
                   fmt::arg("name", name), fmt::arg("index", index), fmt::arg("least", least_n(curve)),
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

void write_axes(Text out, bool left, bool bottom, const std::string& row_label, bool seconds) {
    fmt::format_to(out, "set format y '{}'; set format x '{}'\n", left ? "%g" : "", bottom ? "%g" : "");
    if (left) {
        fmt::format_to(out, "set ylabel \"{{/:Bold {}}}\\ndepth (% of fixture)\" offset -0.3\n", row_label);
    } else {
        fmt::format_to(out, "unset ylabel\n");
    }
    const char* label = seconds ? "time from contact (s)" : "time, entry to beep (%)";
    fmt::format_to(out, "{}\n", bottom ? fmt::format("set xlabel '{}'", label) : "unset xlabel");
}

// Where the mean enters the tissue, where the axis begins, and at the beep.
void write_events(Text out, const MeanCurve& curve, const std::pair<double, double>& range) {
    fmt::format_to(out, "unset arrow; unset label\n");
    const auto mark = [&](double at, const char* words, double height) {
        if (!(at >= range.first && at <= range.second)) return;
        fmt::format_to(out,
                       "set arrow from {0:.4g}, graph 0 to {0:.4g}, graph 1 nohead dashtype (2,3) linecolor "
                       "'#666666' back\n"
                       "set label '{{/*0.85 {1}}}' at {0:.4g}, graph {2} {3} textcolor '#444444'\n",
                       at, words, height, at > (range.first + range.second) / 2 ? "right" : "left");
    };
    if (curve.mean.entry.n > 0) mark(curve.mean.entry.mean, " entry ", 0.96);
    if (in_seconds(curve) && curve.n() > 0) mark(0, " contact ", 0.89);
    if (curve.mean.beep.n > 0) mark(curve.mean.beep.mean, " beep ", 0.96);
}

void write_shared_axes(Text out, const DepthRange& depth, const std::pair<double, double>& time) {
    const double depth_percent = depth.high_percent - depth.low_percent, span = time.second - time.first;
    fmt::format_to(out, R"(set macros; unset key
set xrange [{:g}:{:g}]; set xtics {:g}
set yrange [{}:{}]; set ytics {:g}
set multiplot
)",
                   time.first, time.second, span > 100 ? 25 : nice_step(span, 8), depth.low_percent,
                   depth.high_percent, depth_percent <= 200 ? 25 : nice_step(depth_percent, 7));
}

std::string trajectory_script(const TrajectoryGrid& of, const std::string& name) {
    const FigureGrid grid = layout(of);
    std::string script = gnuplot_preamble(name, grid.width_px(), grid.height_px());
    const Text out(script);
    const auto time = time_range(of.cells);
    write_shared_axes(out, depth_range(of.cells), time);
    for (std::size_t i = 0; i < of.cells.size(); ++i) {
        const TrajectoryCell& cell = of.cells[i];
        script += grid.margins(cell.row, cell.column);
        write_axes(out, is_first_of_its_row(of, cell), is_last_of_its_column(of, cell),
                   of.row_labels[cell.row], in_seconds(cell.curve));
        write_events(out, cell.curve, time);
        fmt::format_to(out, "set title '{{/:Bold {}}}  {}' offset 0,-0.6\n", cell.title, n_text(cell.curve));
        write_curves(out, name, i, cell.curve);
    }
    return script + grid.key() + "unset multiplot\n";
}

std::string axis_text(bool seconds) {
    return seconds ? "Time from the needle's first contact with the fixture (0 s). Depth in percent: 0 % is "
                     "the tissue surface at rest, 100 % the trial's fixture. Vertical lines: mean entry into "
                     "the tissue, first contact, and mean beep. "
                   : "Depth in percent: 0 % is the tissue surface at rest, 100 % the trial's fixture. Each "
                     "trial's time is stretched, from "
                     "tissue entry (0 %) to the beep (100 %). ";
}

struct TrajectoryCounts {
    std::uint32_t low = ~0U, high = 0, with_beep = 0, without_beep = 0, left_out = 0;
    bool of_subjects = true, seconds = true;

    void add(const MeanCurve& curve) {
        low = std::min(low, curve.n());
        high = std::max(high, curve.n());
        with_beep += curve.trials_with_beep;
        without_beep += curve.trials_without_beep;
        left_out += curve.trials_left_out;
        of_subjects = of_subjects && curve.subjects > 1;
        seconds = in_seconds(curve);
    }
};

std::string trajectory_caption(const std::vector<TrajectoryCell>& cells) {
    TrajectoryCounts counts;
    for (const TrajectoryCell& cell : cells) counts.add(cell.curve);
    return fmt::format(
        "Needle and tissue surface (dashed). {}Mean with a band of one standard deviation over n = {} {} per "
        "panel. Grey: the needle of one single trial, because a mean over trials of different phase hides an "
        "oscillation. {} trials ended with a beep. {} ended without one, and their end is used instead. {} "
        "never {} and are left out. Means are drawn where at least half of the {} have samples.",
        axis_text(counts.seconds), range_text(std::min(counts.low, counts.high), counts.high),
        counts.of_subjects ? "subjects, whose trials are averaged first," : "trials", counts.with_beep,
        counts.without_beep, counts.left_out, counts.seconds ? "touched the fixture" : "entered the tissue",
        counts.of_subjects ? "subjects" : "trials");
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
    for (const Modality modality : kFigureOrder) {
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
            grid.cells.push_back(cell_of(row, column, to_string(panel->modality), *panel));
        }
    }
    return trajectory_source(grid, name, "Trajectories");
}

FigureSource all_trajectories_figure(const PanelsByExperiment& experiments, const std::string& name) {
    TrajectoryGrid grid;
    grid.columns = experiments.size();
    grid.panel_height_px = 165;
    for (const Modality modality : kFigureOrder) grid.row_labels.emplace_back(to_string(modality));
    std::size_t column = 0;
    for (const auto& [experiment, panels] : experiments) {
        for (std::size_t row = 0; row < kFigureOrder.size(); ++row) {
            const TrajectoryPanel* panel = own_panel(panels, kFigureOrder[row]);
            if (panel == nullptr) continue;
            grid.cells.push_back(cell_of(row, column,
                                         fmt::format("Experiment {} ({}), {}", experiment,
                                                     delay_text(panel->delay_s), to_string(panel->modality)),
                                         *panel));
        }
        ++column;
    }
    return trajectory_source(grid, name, "Trajectories, side by side");
}

}  // namespace thimble
