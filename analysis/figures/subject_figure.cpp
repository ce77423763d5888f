#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "analysis/figures/figure_grid.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/figures/measure_axes.hpp"
#include "analysis/statistics/descriptive.hpp"
#include "analysis/text/gnuplot.hpp"

namespace thimble {
namespace {

constexpr std::string_view kSubjectLine =
    "with linespoints pointtype 6 pointsize 0.35 linewidth 0.7 linecolor '#777777'";
constexpr std::string_view kMeanLine =
    "with linespoints pointtype 7 pointsize 0.9 linewidth 2.5 linecolor 'black'";

using MeasureColumns = std::vector<std::vector<NamedValues>>;  // of each measure

double mean_of_numbers(NamedValues column) {
    std::erase_if(column.values, [](double value) { return std::isnan(value); });
    return column.values.empty() ? std::nan("") : sample_mean(column);
}

// A block per measure, a line per modality: place on the axis, mean, then every subject.
std::string subject_data(const StudyColumns& of, const MeasureColumns& measures,
                         const std::vector<Metric>& metrics) {
    std::string data;
    for (std::size_t i = 0; i < metrics.size(); ++i) {
        data += fmt::format("# {}: x, mean, subjects", info(metrics[i]).label);
        for (const std::uint32_t subject : of.subjects()) data += fmt::format(" {}", subject);
        data += "\n";
        double x = 0;
        for (const NamedValues& column : measures[i]) {
            write_cell(data, x++);
            write_shown(data, mean_of_numbers(column), metrics[i]);
            for (const double value : column.values) write_shown(data, value, metrics[i]);
            data.back() = '\n';
        }
        data += "\n\n";
    }
    return data;
}

std::string subject_script(const StudyColumns& of, const MeasureColumns& measures,
                           const std::vector<Metric>& metrics, const std::string& name) {
    FigureGrid grid = measure_grid(metrics.size(), places_of(measures[0]));
    grid.entries = {{std::string(kSubjectLine), "one subject"},
                    {std::string(kMeanLine), "mean of all subjects"}};
    std::string script = gnuplot_preamble(name, grid.width_px(), grid.height_px());
    script += "unset key\nset multiplot\n";
    for (std::size_t i = 0; i < metrics.size(); ++i) {
        script += grid.margins(0, i) + place_axis(places_of(measures[i])) +
                  measure_axis(metrics[i], values_of(measures[i]));
        script += fmt::format(
            "plot for [subject=3:{last}] '{name}.tsv' index {i} using 1:subject {subject} notitle, \\\n"
            "     '{name}.tsv' index {i} using 1:2 {mean} notitle\n",
            fmt::arg("last", of.subjects().size() + 2), fmt::arg("name", name), fmt::arg("i", i),
            fmt::arg("subject", kSubjectLine), fmt::arg("mean", kMeanLine));
    }
    return script + grid.key() + "unset multiplot\n";
}

}  // namespace

FigureSource subject_figure(const StudyColumns& columns, const std::vector<Metric>& metrics,
                            const std::string& name) {
    if (columns.empty() || metrics.empty()) return {};
    MeasureColumns measures;
    for (const Metric metric : metrics) measures.push_back(columns.subject_means(metric));
    measures = present_columns(std::move(measures));
    return {name, "Every subject",
            fmt::format("{} The trials of each subject are averaged per modality. n: subjects with this "
                        "measure. Black: mean over these subjects.",
                        trials_text(columns)),
            subject_data(columns, measures, metrics), subject_script(columns, measures, metrics, name)};
}

}  // namespace thimble
