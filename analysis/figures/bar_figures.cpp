#include <algorithm>
#include <array>
#include <iterator>

#include <fmt/format.h>

#include "analysis/figures/figure_grid.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/text/gnuplot.hpp"

namespace thimble {
namespace {

using Shown = std::array<Metric, 2>;

// Depth and time; where the fixture was removed the depth that counts is how far the needle then jumped.
Shown shown_of(const std::vector<ConditionSummary>& conditions) {
    const bool removed = std::any_of(conditions.begin(), conditions.end(), [](const ConditionSummary& c) {
        return c.of(Metric::kPeakDisplacement).n > 0;
    });
    return {removed ? Metric::kPeakDisplacement : Metric::kPenetrationMax, Metric::kCompletionTime};
}

constexpr std::array kDelayColours{kSkyBlue, kVermilion, kGreen, kPurple, kBlue};
// Width that the bars of one modality share; the rest of 1 is the gap to the next.
constexpr double kGroup = 0.76;

// A block per delay, a line per modality: place on the axis, then mean and SD of each metric as shown.
std::string bar_data(const std::vector<ConditionSummary>& conditions, const std::vector<double>& delays_s,
                     const Shown& shown) {
    std::string data = "# x, then for each metric: mean, sd\n";
    const double width = kGroup / static_cast<double>(delays_s.size());
    for (std::size_t block = 0; block < delays_s.size(); ++block) {
        data += fmt::format("# {}\n", delay_text(delays_s[block]));
        for (std::size_t i = 0; i < kModalities.size(); ++i) {
            const auto condition = find_condition(conditions, kModalities[i], delays_s[block]);
            const double offset = -kGroup / 2 + width * (static_cast<double>(block) + 0.5);
            write_cell(data, static_cast<double>(i) + offset);
            for (const Metric metric : shown) {
                const Statistic statistic =
                    condition == conditions.end() ? Statistic{} : condition->of(metric);
                write_shown(data, statistic.mean, metric);
                write_shown(data, statistic.sd, metric);
            }
            data.back() = '\n';
        }
        data += "\n\n";
    }
    return data;
}

std::string bar_panel(const std::string& name, std::size_t panel, const std::vector<double>& delays_s,
                      const Shown& shown) {
    const std::size_t mean = 2 + 2 * panel;
    std::string script = fmt::format("set ylabel '{}'\nplot ", info(shown[panel]).label);
    for (std::size_t block = 0; block < delays_s.size(); ++block) {
        script += fmt::format(
            "'{}.tsv' index {} using 1:{} with boxes fillstyle solid 0.85 noborder linecolor '{}' title '{} "
            "delay', \\\n     ",
            name, block, mean, kDelayColours[block % kDelayColours.size()], delay_text(delays_s[block]));
    }
    // Whiskers as arrows with flat heads: error bars come with a point, which leaves a white hole in the bar.
    for (std::size_t block = 0; block < delays_s.size(); ++block) {
        script += fmt::format(
            "'{0}.tsv' index {1} using 1:(${2}-${3}):(0):(2*${3}) with vectors heads size graph 0.01,90 "
            "linewidth 1.2 linecolor '#222222' notitle{4}\n",
            name, block, mean, mean + 1, block + 1 < delays_s.size() ? ", \\" : "");
    }
    return script;
}

std::string bar_script(const std::string& name, const std::vector<double>& delays_s, const Shown& shown) {
    std::string script = gnuplot_preamble(name, 1000, 380);
    script += fmt::format(R"(set boxwidth {:.4f} absolute
set xrange [-0.6:3.6]; set yrange [0:*]; set offsets 0, 0, graph 0.06, 0; set xtics scale 0 ({})
set xlabel 'modality'
set key at screen 0.53, screen 0.975 center top horizontal samplen 1.2 width 2
set tmargin at screen 0.87; set bmargin at screen 0.16
set multiplot
set lmargin at screen 0.075; set rmargin at screen 0.485
)",
                          kGroup / static_cast<double>(delays_s.size()) * 0.92, modality_tics());
    script += bar_panel(name, 0, delays_s, shown);
    script += "unset key\nset lmargin at screen 0.575; set rmargin at screen 0.985\n";
    script += bar_panel(name, 1, delays_s, shown);
    return script + "unset multiplot\n";
}

std::string bar_caption(const std::vector<ConditionSummary>& conditions, const Shown& shown) {
    std::uint32_t subjects_low = ~0U, subjects_high = 0, trials_low = ~0U, trials_high = 0;
    for (const ConditionSummary& condition : conditions) {
        subjects_low = std::min(subjects_low, condition.subjects);
        subjects_high = std::max(subjects_high, condition.subjects);
        trials_low = std::min(trials_low, condition.judged);
        trials_high = std::max(trials_high, condition.judged);
    }
    return fmt::format(
        "By one-way delay: {}, and time from tissue entry to the beep: mean and standard deviation over n = "
        "{} subjects, whose trials are averaged first ({} trials per bar). Trials without a beep have no "
        "completion time.",
        shown[0] == Metric::kPeakDisplacement
            ? "how far the needle jumps when the fixture vanishes"
            : "maximum penetration beyond the fixture between first contact and beep",
        range_text(std::min(subjects_low, subjects_high), subjects_high),
        range_text(std::min(trials_low, trials_high), trials_high));
}

Shown bars_of(const StudyColumns& columns) {
    return {columns.experiment() == 2 ? Metric::kPeakDisplacement : Metric::kPenetrationMax,
            Metric::kCompletionTime};
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

FigureSource bar_figure(const std::vector<ConditionSummary>& conditions, const std::string& name) {
    const std::vector<double> delays_s = delays_of(conditions);
    const Shown shown = shown_of(conditions);
    return {name,
            shown[0] == Metric::kPeakDisplacement ? "Displacement and completion time"
                                                  : "Penetration and completion time",
            bar_caption(conditions, shown), bar_data(conditions, delays_s, shown),
            bar_script(name, delays_s, shown)};
}

FigureSource all_bars_figure(const std::vector<StudyColumns>& experiments, const std::string& name) {
    return {name, "Depth and time, side by side",
            "Mean and standard deviation over subjects, whose trials are averaged first. Above: maximum "
            "penetration beyond the fixture; in experiment 2 how far the needle jumps when the fixture "
            "vanishes. Below: time from tissue entry to the beep.",
            bar_data(experiments), bar_script(experiments, name)};
}

}  // namespace thimble
