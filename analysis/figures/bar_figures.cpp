#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "analysis/figures/figure_grid.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/figures/measure_axes.hpp"
#include "analysis/text/gnuplot.hpp"

namespace thimble {
namespace {

using Shown = std::vector<Metric>;

// Width that the bars of one modality share; the rest of 1 is the gap to the next.
constexpr double kGroup = 0.76;

// Error bars as arrows with flat heads: gnuplot's error bars draw a point that leaves a white hole in the bar.
std::string whisker(std::size_t blocks) {
    const double head = std::min(0.005, 0.02 / static_cast<double>(blocks));
    return fmt::format("with vectors heads size screen {:.4f},90 linewidth 1.3 linecolor 'black'", head);
}

// Bars of one measure: a line per modality, in it a bar per delay.
struct BarPanel {
    std::string title;
    Metric metric;
    std::vector<Modality> modalities;
    std::vector<std::vector<Statistic>> bars;  // n = 0 where there is no such condition
};

// The darker, the longer the delay.
std::string delay_colour(std::size_t block, std::size_t blocks) {
    constexpr Colour kLight{190, 224, 245};
    if (blocks == 1) return fmt::format("{}", kSkyBlue);
    Colour colour{};
    for (std::size_t i = 0; i < colour.size(); ++i) {
        const double part = static_cast<double>(block) / static_cast<double>(blocks - 1);
        colour[i] = static_cast<std::uint8_t>(std::lround(std::lerp(kLight[i], kBlue[i], part)));
    }
    return fmt::format("{}", colour);
}

Statistic statistic_of(const std::vector<ConditionSummary>& conditions, Modality modality, double delay_s,
                       Metric metric) {
    const auto condition = find_condition(conditions, modality, delay_s);
    return condition == conditions.end() ? Statistic{} : condition->of(metric);
}

BarPanel bar_panel(std::string title, const std::vector<ConditionSummary>& conditions, Metric metric,
                   const std::vector<double>& delays_s) {
    BarPanel panel{std::move(title), metric, {}, {}};
    for (const Modality modality : kFigureOrder) {
        if (std::none_of(conditions.begin(), conditions.end(),
                         [&](const ConditionSummary& c) { return c.modality == modality; }))
            continue;
        panel.modalities.push_back(modality);
        panel.bars.emplace_back();
        for (const double delay_s : delays_s)
            panel.bars.back().push_back(statistic_of(conditions, modality, delay_s, metric));
    }
    return panel;
}

std::string n_of(const std::vector<Statistic>& bars) {
    const auto [low, high] = std::minmax_element(
        bars.begin(), bars.end(), [](const Statistic& a, const Statistic& b) { return a.n < b.n; });
    return range_text(low->n, high->n);
}

double place_of(std::size_t modality, std::size_t block, std::size_t blocks) {
    const double width = kGroup / static_cast<double>(blocks);
    return static_cast<double>(modality) - kGroup / 2 + width * (static_cast<double>(block) + 0.5);
}

// A bar too low to be seen is named by its value.
std::string value_of_low_bar(const Statistic& bar, const BarPanel& panel) {
    constexpr double kLow = 0.02;
    double highest = 0;
    for (const std::vector<Statistic>& bars : panel.bars) {
        for (const Statistic& other : bars) highest = std::max(highest, other.mean);
    }
    return bar.n > 0 && std::abs(bar.mean) <= kLow * highest ? shown_text(bar.mean, panel.metric) : "";
}

// A block per panel and delay, a line per modality: place on the axis, mean, SD, top, value if it cannot be seen.
std::string bar_data(const std::vector<BarPanel>& panels, std::size_t blocks) {
    std::string data;
    for (const BarPanel& panel : panels) {
        for (std::size_t block = 0; block < blocks; ++block) {
            data += fmt::format("# {}: x, mean, sd, top, value of a low bar\n", info(panel.metric).label);
            for (std::size_t m = 0; m < panel.bars.size(); ++m) {
                const Statistic& bar = panel.bars[m][block];
                write_cell(data, place_of(m, block, blocks));
                write_shown(data, bar.mean, panel.metric);
                write_shown(data, bar.sd, panel.metric);
                write_shown(data, std::isnan(bar.sd) ? bar.mean : bar.mean + bar.sd, panel.metric);
                data += fmt::format("\"{}\"\n", value_of_low_bar(bar, panel));
            }
            data += "\n\n";
        }
    }
    return data;
}

std::string axes(const BarPanel& panel) {
    std::vector<AxisPlace> places;
    std::vector<double> ends{0};
    for (std::size_t m = 0; m < panel.bars.size(); ++m) {
        places.push_back({to_string(panel.modalities[m]), n_of(panel.bars[m])});
        for (const Statistic& bar : panel.bars[m]) {
            const double sd = std::isnan(bar.sd) ? 0 : bar.sd;
            ends.push_back(bar.mean + sd);
            ends.push_back(std::min(0.0, bar.mean - sd));
        }
    }
    return place_axis(places) + measure_axis(panel.metric, ends);
}

std::string bar_style(std::size_t block, std::size_t blocks) {
    return fmt::format("with boxes fillstyle solid noborder linecolor '{}'", delay_colour(block, blocks));
}

std::string panel_script(const BarPanel& panel, std::size_t index, std::size_t blocks,
                         const std::string& name) {
    std::string script = panel.title.empty()
                             ? "unset title\n"
                             : fmt::format("set title '{{/:Bold {}}}' offset 0,-0.6\n", panel.title);
    script += axes(panel) + "plot ";
    for (std::size_t block = 0; block < blocks; ++block) {
        script += fmt::format("{}'{}.tsv' index {} using 1:2 {}", block > 0 ? ", \\\n     " : "", name,
                              index * blocks + block, bar_style(block, blocks));
    }
    for (std::size_t block = 0; block < blocks; ++block) {
        script += fmt::format(
            ", \\\n     '{0}.tsv' index {1} using 1:($2-$3):(0):(2*$3) {2}, \\\n"
            "     '{0}.tsv' index {1} using 1:4:5 with labels font ',11' offset 0,0.6",
            name, index * blocks + block, whisker(blocks));
    }
    return script + "\n";
}

bool has_whiskers(const std::vector<BarPanel>& panels) {
    return std::any_of(panels.begin(), panels.end(), [](const BarPanel& panel) {
        return std::any_of(panel.bars.begin(), panel.bars.end(), [](const std::vector<Statistic>& bars) {
            return std::any_of(bars.begin(), bars.end(), [](const Statistic& bar) { return bar.n > 1; });
        });
    });
}

std::vector<KeyEntry> key_entries(const std::vector<BarPanel>& panels,
                                  const std::vector<std::string>& titles) {
    std::vector<KeyEntry> entries;
    for (std::size_t block = 0; block < titles.size(); ++block)
        entries.push_back({bar_style(block, titles.size()), titles[block]});
    if (has_whiskers(panels)) entries.push_back({whisker(titles.size()), "± SD over n subjects"});
    return entries;
}

// Panels fill the grid column by column.
std::string bar_script(const std::vector<BarPanel>& panels, const FigureGrid& grid, std::size_t blocks,
                       const std::string& name) {
    std::string script = gnuplot_preamble(name, grid.width_px(), grid.height_px());
    script += fmt::format("set boxwidth {:.4f} absolute; unset key\nset multiplot\n",
                          kGroup / static_cast<double>(blocks) * 0.92);
    for (std::size_t i = 0; i < panels.size(); ++i)
        script += grid.margins(i % grid.rows, i / grid.rows) + panel_script(panels[i], i, blocks, name);
    return script + grid.key() + "unset multiplot\n";
}

// The paper's measures: average and maximum penetration, and time; where the fixture was removed how far the needle then jumped.
Shown shown_of(const std::vector<ConditionSummary>& conditions) {
    const bool removed = std::any_of(conditions.begin(), conditions.end(), [](const ConditionSummary& c) {
        return c.of(Metric::kPeakDisplacement).n > 0;
    });
    if (removed) return {Metric::kPeakDisplacement, Metric::kCompletionTime};
    return {Metric::kPenetrationMean, Metric::kPenetrationMax, Metric::kCompletionTime};
}

std::string bar_caption(const std::vector<ConditionSummary>& conditions, const Shown& shown) {
    std::uint32_t subjects = 0, trials_low = ~0U, trials_high = 0;
    for (const ConditionSummary& condition : conditions) {
        subjects = std::max(subjects, condition.subjects);
        trials_low = std::min(trials_low, condition.judged);
        trials_high = std::max(trials_high, condition.judged);
    }
    return fmt::format(
        "By one-way delay: {}, and time from tissue entry to the beep. Bars: mean over n subjects (n stands "
        "below the bar), whose trials are averaged first ({} trials of {} subjects per condition); whiskers: "
        "± one standard deviation over these subjects. Trials without a beep have no completion time.",
        shown[0] == Metric::kPeakDisplacement
            ? "how far the needle jumps when the fixture vanishes"
            : "average and maximum penetration beyond the fixture between first contact and beep",
        range_text(std::min(trials_low, trials_high), trials_high), subjects);
}

// The trials of each modality with its longest delay, as the trajectories side by side show.
std::vector<ConditionSummary> with_longest_delay(std::vector<ConditionSummary> conditions) {
    std::vector<ConditionSummary> longest;
    for (const Modality modality : kFigureOrder) {
        const auto last = std::find_if(conditions.rbegin(), conditions.rend(),
                                       [&](const ConditionSummary& c) { return c.modality == modality; });
        if (last == conditions.rend()) continue;
        longest.push_back(*last);
        longest.back().delay_s = 0;  // one block for all of them
    }
    return longest;
}

}  // namespace

FigureSource bar_figure(const std::vector<ConditionSummary>& conditions, const std::string& name) {
    const std::vector<double> delays_s = delays_of(conditions);
    const Shown shown = shown_of(conditions);
    std::vector<BarPanel> panels;
    panels.reserve(shown.size());
    for (const Metric metric : shown) panels.push_back(bar_panel("", conditions, metric, delays_s));
    std::vector<std::string> titles;
    titles.reserve(delays_s.size());
    for (const double delay_s : delays_s) titles.push_back(delay_text(delay_s) + " delay");
    FigureGrid grid;
    grid.columns = panels.size();
    grid.panel_width_px = panels.size() == 2 ? 400 : 280;
    grid.panel_height_px = 260;
    grid.entries = key_entries(panels, titles);
    return {name,
            shown[0] == Metric::kPeakDisplacement ? "Displacement and completion time"
                                                  : "Penetration and completion time",
            bar_caption(conditions, shown), bar_data(panels, delays_s.size()),
            bar_script(panels, grid, delays_s.size(), name)};
}

FigureSource all_bars_figure(const std::vector<StudyColumns>& experiments, const std::string& name) {
    std::vector<BarPanel> panels;
    for (const StudyColumns& columns : experiments) {
        const auto conditions = with_longest_delay(summarize(columns.rows()));
        const Metric depth = columns.experiment() == 2 ? Metric::kPeakDisplacement : Metric::kPenetrationMax;
        panels.push_back(bar_panel(fmt::format("Experiment {}", columns.experiment()), conditions,
                                   Metric::kPenetrationMean, {0}));
        panels.push_back(bar_panel("", conditions, depth, {0}));
        panels.push_back(bar_panel("", conditions, Metric::kCompletionTime, {0}));
    }
    FigureGrid grid;
    grid.columns = experiments.size();
    grid.rows = 3;
    grid.panel_height_px = 180;
    grid.head_px = 30;
    grid.entries = key_entries(panels, {"mean"});
    return {name, "Depth and time, side by side",
            "Bars: mean over n subjects (n stands below the bar), whose trials are averaged first; whiskers: "
            "± one standard deviation. Above: average penetration beyond the fixture. Middle: maximum "
            "penetration; in experiment 2 how far the needle jumps when the fixture vanishes. Below: time "
            "from tissue entry to the beep.",
            bar_data(panels, 1), bar_script(panels, grid, 1, name)};
}

}  // namespace thimble
