#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "analysis/figures/figure_grid.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/figures/measure_axes.hpp"
#include "analysis/tables/comparisons.hpp"
#include "analysis/text/gnuplot.hpp"

namespace thimble {
namespace {

constexpr std::string_view kSubjectPoint = "with points pointtype 6 pointsize 0.35 linecolor '#777777'";

std::string estimate_point() {
    return fmt::format("with xerrorbars pointtype 7 pointsize 0.7 linewidth 3 linecolor '{}'", kBlue);
}

// A panel.
struct Differences {
    Metric metric;
    std::size_t column = 0, row = 0;  // of the figure
    std::vector<ConditionPair> pairs;
    std::vector<NamedValues> columns;  // a value per subject; NaN: none
};

bool with_handle(const ConditionPair& pair) {
    return pair.first.starts_with("HF") || pair.second.starts_with("HF");
}

bool is_judged(const ConditionPair& pair) { return pair.can_be_judged(); }

// A single subject has no spread to show.
Differences differences_of(const StudyColumns& columns, Metric metric) {
    Differences all{metric, 0, 0, compare_conditions(columns, metric), columns.subject_means(metric)};
    std::erase_if(all.pairs, [](const ConditionPair& pair) { return !pair.shift || pair.n < 2; });
    return all;
}

// First minus second, of each subject that has both; none of independent trials.
std::vector<double> of_subjects(const Differences& of, const ConditionPair& pair) {
    std::vector<double> differences;
    if (!pair.paired) return differences;
    const auto column = [&](const std::string& name) {
        return std::find_if(of.columns.begin(), of.columns.end(),
                            [&](const NamedValues& values) { return values.name == name; });
    };
    const auto first = column(pair.first), second = column(pair.second);
    for (std::size_t s = 0; s < first->values.size(); ++s) {
        const double difference = first->values[s] - second->values[s];
        if (!std::isnan(difference)) differences.push_back(difference);
    }
    return differences;
}

// Too few subjects give an estimate without an interval: a point without bars.
ConfidenceInterval interval_of(const ConditionPair& pair) {
    return pair.shift->interval.value_or(ConfidenceInterval{pair.shift->estimate, pair.shift->estimate});
}

// The pairs with HF above those without: an oscillating HF is ten times as far from the others as they are from each other, so
// each has a scale of its own. A column of panels per measure that has differences.
std::vector<Differences> panels_of(const StudyColumns& columns, const std::vector<Metric>& metrics) {
    std::vector<Differences> panels;
    std::size_t column = 0;
    for (const Metric metric : metrics) {
        const Differences all = differences_of(columns, metric);
        std::size_t row = 0;
        for (const bool handle : {true, false}) {
            Differences part = all;
            std::erase_if(part.pairs, [&](const ConditionPair& pair) { return with_handle(pair) != handle; });
            if (part.pairs.empty()) continue;
            part.column = column;
            part.row = row++;
            panels.push_back(std::move(part));
        }
        column += row > 0 ? 1 : 0;
    }
    return panels;
}

bool any_judged(const std::vector<Differences>& panels) {
    return std::any_of(panels.begin(), panels.end(), [](const Differences& of) {
        return std::any_of(of.pairs.begin(), of.pairs.end(), is_judged);
    });
}

void write_estimates(std::string& data, const Differences& of) {
    double y = 0;
    for (const ConditionPair& pair : of.pairs) {
        const ConfidenceInterval interval = interval_of(pair);
        write_cell(data, y++);
        for (const double value : {pair.shift->estimate, interval.low, interval.high})
            write_shown(data, value, of.metric);
        data.back() = '\n';
    }
}

void write_subjects(std::string& data, const Differences& of) {
    double y = 0;
    for (const ConditionPair& pair : of.pairs) {
        for (const double difference : of_subjects(of, pair)) {
            write_cell(data, y - 0.25);
            write_shown(data, difference, of.metric);
            data.back() = '\n';
        }
        ++y;
    }
    data += "NaN NaN\n";  // gnuplot does not count a block without numbers
}

std::string difference_data(const std::vector<Differences>& panels) {
    std::string data;
    for (const Differences& of : panels) {
        data += fmt::format("# {}: y, difference, its 95 % interval of all pairs at once\n",
                            info(of.metric).label);
        write_estimates(data, of);
        data += "\n\n# y, difference of one subject\n";
        write_subjects(data, of);
        data += "\n\n";
    }
    return data;
}

std::vector<double> shown_values(const Differences& of) {
    std::vector<double> values;
    const double shown = info(of.metric).shown_per_si;
    for (const ConditionPair& pair : of.pairs) {
        const ConfidenceInterval interval = interval_of(pair);
        values.insert(values.end(), {shown * interval.low, shown * interval.high});
        for (const double difference : of_subjects(of, pair)) values.push_back(shown * difference);
    }
    return values;
}

std::string axes(const Differences& of) {
    const std::string pairs = numbered_tics(
        of.pairs.size(), [&](std::size_t i) { return of.pairs[i].first + " − " + of.pairs[i].second; });
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
        for (const ConditionPair& pair : of.pairs)
            longest = std::max(longest, pair.first.size() + pair.second.size());
    }
    grid.panel_height_px = 40 * static_cast<int>(std::max<std::size_t>(most, 2));
    grid.left_px = 44 + 8 * static_cast<int>(longest);
    grid.between_px = grid.left_px + 16;
    grid.beneath_px = 74;
    if (panels[0].pairs[0].paired) grid.entries.push_back({std::string(kSubjectPoint), "one subject"});
    grid.entries.push_back(
        {fmt::format("with linespoints pointtype 7 pointsize 0.7 linewidth 3 linecolor '{}'", kBlue),
         any_judged(panels) ? "estimate, 95 % confidence interval" : "estimate"});
    return grid;
}

std::string panel_script(std::size_t index, const std::string& name) {
    return fmt::format(
        "plot '{name}.tsv' index {subjects} using 2:1 {subject}, \\\n"
        "     '{name}.tsv' index {estimates} using 2:1:3:4 {estimate}\n",
        fmt::arg("name", name), fmt::arg("estimates", 2 * index), fmt::arg("subjects", 2 * index + 1),
        fmt::arg("subject", kSubjectPoint), fmt::arg("estimate", estimate_point()));
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
    std::size_t low = panels[0].pairs[0].n, high = low, few = 0;
    for (const Differences& of : panels) {
        for (const ConditionPair& pair : of.pairs) {
            low = std::min(low, pair.n);
            high = std::max(high, pair.n);
            few += is_judged(pair) ? 0 : 1;
        }
    }
    const bool paired = panels[0].pairs[0].paired;
    return fmt::format("n = {} {} per pair. The intervals belong to the {} test of the table.{}",
                       range_text(low, high), paired ? "subjects" : "trials",
                       paired ? "signed-rank" : "rank-sum",
                       few > 0 ? " Pairs with too few for a test have no interval." : "");
}

}  // namespace

FigureSource difference_figure(const StudyColumns& columns, const std::vector<Metric>& metrics,
                               const std::string& name) {
    const std::vector<Differences> panels = panels_of(columns, metrics);
    if (panels.empty()) return {};
    return {
        name, "Differences",
        fmt::format(
            "{} First minus second modality: Hodges-Lehmann estimate with the 95 % confidence interval for "
            "all pairs of a measure at once. {} Pairs with HF and pairs without HF have different scales.",
            trials_text(columns), how(panels)),
        difference_data(panels), difference_script(panels, name)};
}

}  // namespace thimble
