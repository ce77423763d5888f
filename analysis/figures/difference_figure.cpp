#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "analysis/figures/figure_grid.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/figures/measure_axes.hpp"
#include "analysis/statistics/pairwise.hpp"
#include "analysis/text/gnuplot.hpp"
#include "common/error.hpp"

namespace thimble {
namespace {

constexpr std::string_view kSubjectPoint = "with points pointtype 6 pointsize 0.35 linecolor '#777777'";
constexpr std::string_view kAllAtOnce =
    "with xerrorbars pointtype 7 pointsize 0.1 linewidth 1 linecolor 'black'";

std::string mean_point() {
    return fmt::format("with xerrorbars pointtype 7 pointsize 0.7 linewidth 3 linecolor '{}'", kBlue);
}

// A panel.
struct Differences {
    Metric metric;
    std::size_t column = 0, row = 0;  // of the figure
    std::vector<MeanPair> pairs;
    std::vector<NamedValues> columns;  // a value per subject that has all of them; of groups: the trials
    bool paired = false;
};

bool with_handle(const Differences& of, const MeanPair& pair) {
    return of.columns[pair.first].name.starts_with("HF") || of.columns[pair.second].name.starts_with("HF");
}

// None where the statistics refuse the data: the analysis says why.
Differences differences_of(const StudyColumns& columns, Metric metric) {
    Differences all{metric, 0, 0, {}, {}, columns.experiment() != 2};
    try {
        if (all.paired) {
            const SampleTable table =
                complete_rows(present_columns({columns.subject_means(metric)})[0]).table;
            all.pairs = paired_t_tests(table).pairs;
            for (std::size_t i = 0; i < table.conditions(); ++i) all.columns.push_back(table.column(i));
        } else {
            all.columns = present_columns({columns.groups(metric)})[0];
            all.pairs = pairs_after_one_way_anova(all.columns);
        }
    } catch (const Error&) {
        all.pairs.clear();
    }
    return all;
}

// The pairs with HF above those without: an oscillating HF is ten times as far from the others as they are from each other, so
// each has a scale of its own. A column of panels per measure that can be tested.
std::vector<Differences> panels_of(const StudyColumns& columns, const std::vector<Metric>& metrics) {
    std::vector<Differences> panels;
    std::size_t column = 0;
    for (const Metric metric : metrics) {
        const Differences all = differences_of(columns, metric);
        std::size_t row = 0;
        for (const bool handle : {true, false}) {
            Differences part = all;
            std::erase_if(part.pairs, [&](const MeanPair& pair) { return with_handle(all, pair) != handle; });
            if (part.pairs.empty()) continue;
            part.column = column;
            part.row = row++;
            panels.push_back(std::move(part));
        }
        column += row > 0 ? 1 : 0;
    }
    return panels;
}

std::size_t pairs_in(const std::vector<Differences>& panels) {
    std::size_t most = 0, pairs = 0;
    for (const Differences& of : panels) {
        pairs = of.row == 0 ? of.pairs.size() : pairs + of.pairs.size();
        most = std::max(most, pairs);
    }
    return most;
}

void write_means(std::string& data, const Differences& of) {
    double y = 0;
    for (const MeanPair& pair : of.pairs) {
        write_cell(data, y++);
        for (const double value : {pair.difference, pair.interval.low, pair.interval.high,
                                   pair.interval_simultaneous.low, pair.interval_simultaneous.high})
            write_shown(data, value, of.metric);
        data.back() = '\n';
    }
}

void write_subjects(std::string& data, const Differences& of) {
    double y = 0;
    for (const MeanPair& pair : of.pairs) {
        for (std::size_t s = 0; of.paired && s < of.columns[0].values.size(); ++s) {
            write_cell(data, y - 0.25);
            write_shown(data, of.columns[pair.first].values[s] - of.columns[pair.second].values[s],
                        of.metric);
            data.back() = '\n';
        }
        ++y;
    }
    data += "NaN NaN\n";  // gnuplot does not count a block without numbers
}

std::string difference_data(const std::vector<Differences>& panels) {
    std::string data;
    for (const Differences& of : panels) {
        data += fmt::format("# {}: y, difference, 95 % interval, interval of all pairs at once\n",
                            info(of.metric).label);
        write_means(data, of);
        data += "\n\n# y, difference of one subject\n";
        write_subjects(data, of);
        data += "\n\n";
    }
    return data;
}

std::vector<double> shown_values(const Differences& of) {
    std::vector<double> values;
    const double shown = info(of.metric).shown_per_si;
    for (const MeanPair& pair : of.pairs) {
        values.push_back(shown * pair.interval_simultaneous.low);
        values.push_back(shown * pair.interval_simultaneous.high);
        for (std::size_t s = 0; of.paired && s < of.columns[0].values.size(); ++s)
            values.push_back(shown * (of.columns[pair.first].values[s] - of.columns[pair.second].values[s]));
    }
    return values;
}

std::string axes(const Differences& of) {
    const std::string pairs = numbered_tics(of.pairs.size(), [&](std::size_t i) {
        return of.columns[of.pairs[i].first].name + " − " + of.columns[of.pairs[i].second].name;
    });
    // The first pair is on top.
    return fmt::format(
        "set ytics scale 0 ({})\nset yrange [{:.1f}:-0.6]\n{}set xlabel 'difference of {}' offset 0,0.6\n",
        pairs, static_cast<double>(of.pairs.size()) - 0.5, signed_axis(shown_values(of)),
        info(of.metric).label);
}

FigureGrid layout(const std::vector<Differences>& panels) {
    FigureGrid grid = measure_grid(panels.back().column + 1, {});
    std::size_t most = 0, longest = 0;
    for (const Differences& of : panels) {
        grid.rows = std::max(grid.rows, of.row + 1);
        most = std::max(most, of.pairs.size());
        for (const MeanPair& pair : of.pairs)
            longest =
                std::max(longest, of.columns[pair.first].name.size() + of.columns[pair.second].name.size());
    }
    grid.panel_height_px = 40 * static_cast<int>(std::max<std::size_t>(most, 2));
    grid.left_px = 44 + 8 * static_cast<int>(longest);
    grid.between_px = grid.left_px + 16;
    grid.beneath_px = 74;
    if (panels[0].paired) grid.entries.push_back({std::string(kSubjectPoint), "one subject"});
    grid.entries.push_back(
        {fmt::format("with linespoints pointtype 7 pointsize 0.7 linewidth 3 linecolor '{}'", kBlue),
         "mean, 95 % confidence interval"});
    if (pairs_in(panels) > 1)
        grid.entries.push_back({"with lines linewidth 1 linecolor 'black'",
                                fmt::format("95 %, all {} pairs at once", pairs_in(panels))});
    return grid;
}

std::string panel_script(std::size_t index, const std::string& name) {
    return fmt::format(
        "plot '{name}.tsv' index {subjects} using 2:1 {subject}, \\\n"
        "     '{name}.tsv' index {means} using 2:1:5:6 {all}, \\\n"
        "     '{name}.tsv' index {means} using 2:1:3:4 {mean}\n",
        fmt::arg("name", name), fmt::arg("means", 2 * index), fmt::arg("subjects", 2 * index + 1),
        fmt::arg("subject", kSubjectPoint), fmt::arg("all", kAllAtOnce), fmt::arg("mean", mean_point()));
}

std::string difference_script(const std::vector<Differences>& panels, const std::string& name) {
    const FigureGrid grid = layout(panels);
    std::string script = gnuplot_preamble(name, grid.width_px(), grid.height_px());
    script += "set border 1 linecolor '#444444'\nunset key\nset multiplot\n";
    script += "set arrow 1 from 0, graph 0 to 0, graph 1 nohead dashtype (4,3) linecolor '#444444' back\n";
    for (std::size_t i = 0; i < panels.size(); ++i) {
        script += grid.margins(panels[i].row, panels[i].column) + axes(panels[i]);
        script += panel_script(i, name);
    }
    return script + grid.key() + "unset multiplot\n";
}

std::string how(const std::vector<Differences>& panels) {
    if (!panels[0].paired) return "By the error of the one-way ANOVA, over trials.";
    std::size_t low = panels[0].columns[0].values.size(), high = low;
    for (const Differences& of : panels) {
        low = std::min(low, of.columns[0].values.size());
        high = std::max(high, of.columns[0].values.size());
    }
    return fmt::format(
        "By the own differences (paired t) of the n = {} subjects that have the measure in all "
        "conditions.",
        range_text(low, high));
}

}  // namespace

FigureSource difference_figure(const StudyColumns& columns, const std::vector<Metric>& metrics,
                               const std::string& name) {
    const std::vector<Differences> panels = panels_of(columns, metrics);
    if (panels.empty()) return {};
    return {name, "Differences",
            fmt::format("{} First minus second modality: mean with its 95 % confidence interval (thick), and "
                        "the interval that holds for all pairs at once (thin, Bonferroni). {} Pairs with "
                        "HF and without it have scales of their own.",
                        trials_text(columns), how(panels)),
            difference_data(panels), difference_script(panels, name)};
}

}  // namespace thimble
