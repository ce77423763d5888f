#include <string_view>

#include <fmt/format.h>

#include "analysis/figures/figure_grid.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/statistics/pairwise.hpp"
#include "analysis/text/gnuplot.hpp"
#include "common/error.hpp"

namespace thimble {
namespace {

constexpr std::string_view kSubjectPoint = "with points pointtype 6 pointsize 0.35 linecolor '#777777'";
constexpr std::string_view kAllAtOnce =
    "with xerrorbars pointtype 7 pointsize 0.1 linewidth 1 linecolor 'black'";
constexpr std::string_view kMeanPoint =
    "with xerrorbars pointtype 7 pointsize 0.7 linewidth 3 linecolor '#0072B2'";

// A panel.
struct Differences {
    Metric metric;
    std::vector<MeanPair> pairs;
    std::vector<NamedValues> columns;  // of subjects that have all modalities; of groups: empty
};

// The pairs with HF, and those without: an oscillating HF is ten times as far from the others as they are from
// each other, so each has a scale of its own. None where the statistics refuse the data: the analysis says why.
constexpr std::size_t kHalves = 2;
void add_differences(std::vector<Differences>& panels, const StudyColumns& columns, Metric metric) {
    Differences all{metric, {}, {}};
    try {
        if (columns.experiment() == 2) {
            all.pairs = pairs_after_one_way_anova(columns.groups(metric));
        } else {
            const SampleTable table = columns.table(metric).table;
            all.pairs = paired_t_tests(table).pairs;
            for (std::size_t i = 0; i < table.conditions(); ++i) all.columns.push_back(table.column(i));
        }
    } catch (const Error&) {
        return;
    }
    for (const bool with_handle : {true, false}) {
        panels.push_back(all);
        std::erase_if(panels.back().pairs,
                      [&](const MeanPair& pair) { return (pair.first == 0) != with_handle; });
    }
}

void write_means(std::string& data, const Differences& of) {
    double y = 0;
    for (const MeanPair& pair : of.pairs) {
        write_cell(data, y--);
        for (const double value : {pair.difference, pair.interval.low, pair.interval.high,
                                   pair.interval_simultaneous.low, pair.interval_simultaneous.high})
            write_shown(data, value, of.metric);
        data.back() = '\n';
    }
    if (y == 0) data += "NaN NaN NaN NaN NaN NaN\n";  // gnuplot does not count a block without numbers
}

void write_subjects(std::string& data, const Differences& of) {
    double y = 0;
    for (const MeanPair& pair : of.pairs) {
        for (std::size_t s = 0; !of.columns.empty() && s < of.columns[0].values.size(); ++s) {
            write_cell(data, y + 0.25);
            write_shown(data, of.columns[pair.first].values[s] - of.columns[pair.second].values[s],
                        of.metric);
            data.back() = '\n';
        }
        --y;
    }
    data += "NaN NaN\n";
}

std::string difference_data(const std::vector<Differences>& panels) {
    std::string data;
    for (const Differences& of : panels) {
        data += fmt::format("# {}: y, difference, 95 % interval, interval of all six at once\n",
                            info(of.metric).label);
        write_means(data, of);
        data += "\n\n# y, difference of one subject\n";
        write_subjects(data, of);
        data += "\n\n";
    }
    return data;
}

std::string pair_axis(const Differences& of) {
    std::string tics;
    int y = 0;
    for (const MeanPair& pair : of.pairs) {
        tics += fmt::format("{}'{} − {}' {}", tics.empty() ? "" : ", ", to_string(kModalities[pair.first]),
                            to_string(kModalities[pair.second]), y--);
    }
    return fmt::format("set ytics scale 0 ({})\nset xlabel 'difference of {}'\n", tics,
                       info(of.metric).label);
}

std::string difference_script(const std::vector<Differences>& panels, const std::string& name) {
    FigureGrid grid = measure_grid(panels.size() / kHalves);
    grid.rows = kHalves;
    grid.panel_height_px = 120;
    grid.between_px = 100;
    grid.beneath_px = 62;
    grid.foot_px = 62;
    std::string script = gnuplot_preamble(name, grid.width_px(), grid.height_px());
    script += "set yrange [-2.5:0.6]; set xrange [*<0:0<*]; set border 1 linecolor '#444444'\n";
    script += "set arrow 1 from 0, graph 0 to 0, graph 1 nohead dashtype (4,3) linecolor '#444444' back\n";
    script += "set offsets graph 0.03, graph 0.03, 0, 0\nunset key\nset multiplot\n";
    for (std::size_t i = 0; i < panels.size(); ++i) {
        script += grid.margins(i % kHalves, i / kHalves) + pair_axis(panels[i]);
        const bool of_subjects = !panels[i].columns.empty();
        script += fmt::format(
            "plot {subjects}'{name}.tsv' index {means} using 2:1:5:6 {all}, \\\n"
            "     '{name}.tsv' index {means} using 2:1:3:4 {mean}\n",
            fmt::arg("name", name), fmt::arg("means", 2 * i), fmt::arg("all", kAllAtOnce),
            fmt::arg("mean", kMeanPoint),
            fmt::arg("subjects", of_subjects ? fmt::format("'{}.tsv' index {} using 2:1 {}, \\\n     ", name,
                                                           2 * i + 1, kSubjectPoint)
                                             : ""));
    }
    // Lines: the key of an error bar needs a point within the range, which would also be drawn.
    script += grid.key(fmt::format(
        "{}NaN with lines linewidth 3 linecolor '{}' title 'mean, 95 % CI', NaN with lines linewidth 1 "
        "linecolor 'black' title '95 % CI, all six at once'",
        panels[0].columns.empty() ? "" : fmt::format("NaN {} title 'one subject', ", kSubjectPoint), kBlue));
    return script + "unset multiplot\n";
}

}  // namespace

FigureSource difference_figure(const StudyColumns& columns, const std::vector<Metric>& metrics,
                               const std::string& name) {
    std::vector<Differences> panels;
    for (const Metric metric : metrics) add_differences(panels, columns, metric);
    if (panels.empty()) return {};
    return {name, "Differences",
            fmt::format("First minus second modality: mean with its 95 % confidence interval (thick), and "
                        "the interval that holds for all six pairs at once (thin, Bonferroni). {} Pairs with "
                        "HF and without it have scales of their own.",
                        columns.experiment() == 2 ? "By the error of the one-way ANOVA, over trials."
                                                  : "By the subjects' own differences (paired t)."),
            difference_data(panels), difference_script(panels, name)};
}

}  // namespace thimble
