#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "analysis/figures/figure_grid.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/statistics/descriptive.hpp"
#include "analysis/text/gnuplot.hpp"

namespace thimble {
namespace {

constexpr std::string_view kSubjectLine =
    "with linespoints pointtype 6 pointsize 0.35 linewidth 0.7 linecolor '#777777'";
constexpr std::string_view kMeanLine =
    "with linespoints pointtype 7 pointsize 0.9 linewidth 2.5 linecolor 'black'";

// A block per measure, a line per modality: place on the axis, mean, then every subject.
std::string subject_data(const StudyColumns& columns, const std::vector<Metric>& metrics) {
    std::string data;
    for (const Metric metric : metrics) {
        data += fmt::format("# {}: x, mean, subjects", info(metric).label);
        for (const std::uint32_t subject : columns.subjects()) data += fmt::format(" {}", subject);
        data += "\n";
        double x = 0;
        for (const NamedValues& column : columns.subject_means(metric)) {
            NamedValues values = column;
            std::erase_if(values.values, [](double value) { return std::isnan(value); });
            write_cell(data, x++);
            write_shown(data, values.values.empty() ? std::nan("") : sample_mean(values), metric);
            for (const double value : column.values) write_shown(data, value, metric);
            data.back() = '\n';
        }
        data += "\n\n";
    }
    return data;
}

std::string subject_script(const StudyColumns& columns, const std::vector<Metric>& metrics,
                           const std::string& name) {
    const FigureGrid grid = measure_grid(metrics.size());
    std::string script = gnuplot_preamble(name, grid.width_px(), grid.height_px());
    script += modality_axis() + "unset key\nset multiplot\n";
    for (std::size_t i = 0; i < metrics.size(); ++i) {
        script += grid.margins(0, i) + measure_axis(metrics[i], values_of(columns.subject_means(metrics[i])));
        script += fmt::format(
            "plot for [subject=3:{last}] '{name}.tsv' index {i} using 1:subject {subject} notitle, \\\n"
            "     '{name}.tsv' index {i} using 1:2 {mean} notitle\n",
            fmt::arg("last", columns.subjects().size() + 2), fmt::arg("name", name), fmt::arg("i", i),
            fmt::arg("subject", kSubjectLine), fmt::arg("mean", kMeanLine));
    }
    script +=
        grid.key(fmt::format("NaN {} title 'one subject', NaN {} title 'mean'", kSubjectLine, kMeanLine));
    return script + "unset multiplot\n";
}

}  // namespace

FigureSource subject_figure(const StudyColumns& columns, const std::vector<Metric>& metrics,
                            const std::string& name) {
    if (columns.empty() || metrics.empty()) return {};
    return {name, "Every subject",
            fmt::format("{} subjects, the trials of each averaged per modality; black: their mean.{}",
                        columns.subjects().size(),
                        columns.experiment() == 2
                            ? " A subject's line joins the modalities of its trials with sudden removal."
                            : ""),
            subject_data(columns, metrics), subject_script(columns, metrics, name)};
}

}  // namespace thimble
