#include <algorithm>
#include <array>
#include <cmath>

#include <boost/algorithm/string/replace.hpp>
#include <fmt/format.h>

#include "analysis/figures/heat_map.hpp"
#include "analysis/figures/measure_axes.hpp"
#include "analysis/text/gnuplot.hpp"
#include "study/compensators/compensator_report.hpp"

namespace thimble {
namespace {

// Modalities dark and dashed, compensators in colour; what shares a colour differs in dash and point.
struct LineStyle {
    std::string_view condition;
    Colour colour;
    int dash, point;
};
constexpr std::array kStyles{LineStyle{"HF", kBlack, 1, 7},
                             LineStyle{"CF", kBlack, 2, 6},
                             LineStyle{"CCF", kBlack, 3, 4},
                             LineStyle{"VF", kGrey, 2, 8},
                             LineStyle{"scaled", kOrange, 1, 9},
                             LineStyle{"passivity", kSkyBlue, 1, 5},
                             LineStyle{"energy-bound-memoryless", kBluishGreen, 2, 10},
                             LineStyle{"energy-bound", kBluishGreen, 1, 11},
                             LineStyle{"two-layer", kBlue, 1, 13},
                             LineStyle{"local-fixture", kReddishPurple, 1, 7},
                             LineStyle{"wave", kVermillion, 1, 5},
                             LineStyle{"two-port", kBlue, 2, 12}};

LineStyle style_of(std::string_view condition) {
    const auto* const found = std::find_if(
        kStyles.begin(), kStyles.end(), [&](const LineStyle& style) { return style.condition == condition; });
    return found != kStyles.end() ? *found : LineStyle{condition, kGrey, 1, 1};
}

bool is_plain(const CompensatorNetwork& network) { return network.jitter_spread_s <= 0 && network.loss <= 0; }

std::vector<CompensatorNetwork> plain_in(const std::vector<CompensatorRow>& rows) {
    std::vector<CompensatorNetwork> networks = networks_in(rows);
    std::erase_if(networks, [](const CompensatorNetwork& network) { return !is_plain(network); });
    return networks;
}

// "30", or "28-30" where conditions differ.
std::string trials_each(const std::vector<CompensatorRow>& rows) {
    std::uint32_t low = ~0U, high = 0;
    for (const CompensatorRow& row : rows) {
        low = std::min(low, row.trials);
        high = std::max(high, row.trials);
    }
    return range_text(std::min(low, high), high);
}

// As shown; NaN: no such row or value, or none that has a logarithm.
double shown_value(const std::vector<CompensatorRow>& rows, const CompensatorMeasure& measure,
                   const std::string& condition, const CompensatorNetwork& network) {
    const CompensatorRow* const row = find_row(rows, condition, network.name);
    const double value = row != nullptr ? measure.value(*row) : std::nan("");
    return measure.logarithmic && value <= 0 ? std::nan("") : value;
}

// A column per condition.
std::string measure_data(const std::vector<CompensatorRow>& rows, const CompensatorMeasure& measure) {
    std::string data = "# delay, then the conditions\n";
    const std::vector<CompensatorNetwork> networks = plain_in(rows);
    for (std::size_t i = 0; i < networks.size(); ++i) {
        write_cell(data, static_cast<double>(i));
        for (const std::string& condition : conditions_in(rows))
            write_cell(data, shown_value(rows, measure, condition, networks[i]));
        data.back() = '\n';
    }
    return data;
}

std::string measure_axis_of(const std::vector<CompensatorRow>& rows, const CompensatorMeasure& measure) {
    std::vector<double> values;
    for (const CompensatorNetwork& network : plain_in(rows)) {
        for (const std::string& condition : conditions_in(rows))
            values.push_back(shown_value(rows, measure, condition, network));
    }
    return vertical_axis(values, measure.logarithmic);
}

std::string measure_script(const std::vector<CompensatorRow>& rows, const CompensatorMeasure& measure,
                           const std::string& name) {
    const std::vector<CompensatorNetwork> networks = plain_in(rows);
    const std::string tics = numbered_tics(
        networks.size(), [&](std::size_t i) { return fmt::format("{:g}", 1000 * networks[i].delay_s); });
    std::string script = gnuplot_preamble(name, 860, 430);
    script += fmt::format(
        "set xtics ({})\nset xrange [-0.2:{:.1f}]\n"
        "set xlabel 'delay of the force path, one way (ms); n = {} trials per point'\n"
        "set ylabel '{}'\nset key outside right center vertical Left reverse samplen 3 noenhanced\n{}plot ",
        tics, static_cast<double>(networks.size()) - 0.8, trials_each(rows), measure.label,
        measure_axis_of(rows, measure));
    const std::vector<std::string> conditions = conditions_in(rows);
    for (std::size_t i = 0; i < conditions.size(); ++i) {
        const LineStyle style = style_of(conditions[i]);
        script += fmt::format(
            "{}'{}.tsv' using 1:{} with linespoints lw 1.8 dt {} pt {} ps 0.7 lc rgb '{}' title '{}'",
            i > 0 ? ", \\\n     " : "", name, i + 2, style.dash, style.point, style.colour, conditions[i]);
    }
    return script + "\n";
}

std::string shown(double value, int decimals) {
    return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : std::string("-");
}

std::string matrix_cell(const CompensatorRow& row) {
    return fmt::format("{}  {}", shown(1000 * row.penetration_max_m, 1), shown(row.rendered_stiffness, 2));
}

// In percent of trials; one that failed and oscillated counts once.
std::vector<HeatCell> matrix_cells(const std::vector<CompensatorRow>& rows) {
    std::vector<HeatCell> cells;
    const std::vector<std::string> conditions = conditions_in(rows);
    const std::vector<CompensatorNetwork> networks = networks_in(rows);
    for (std::size_t x = 0; x < networks.size(); ++x) {
        for (std::size_t y = 0; y < conditions.size(); ++y) {
            const CompensatorRow* const row = find_row(rows, conditions[y], networks[x].name);
            if (row == nullptr || row->trials == 0) continue;
            const std::uint32_t bad = std::max(row->oscillating, row->trials - row->completed);
            cells.push_back({x, y, 100.0 * bad / row->trials, matrix_cell(*row)});
        }
    }
    return cells;
}

}  // namespace

bool is_stable(const CompensatorRow& row) { return row.completed == row.trials && row.oscillating == 0; }

const std::vector<CompensatorMeasure>& compensator_measures() {
    static const std::vector<CompensatorMeasure> measures{
        {"penetration", "maximum penetration (mm)", 2, true,
         [](const CompensatorRow& r) { return 1000 * r.penetration_max_m; }},
        {"completion", "completion time (s) of completed trials", 1, false,
         [](const CompensatorRow& r) { return r.completion_time_s; }},
        {"oscillating", "trials that oscillate (percent)", 0, false,
         [](const CompensatorRow& r) {
             return r.trials > 0 ? 100.0 * r.oscillating / r.trials : std::nan("");
         }},
        {"movement", "needle movement during the hold, peak to peak (mm)", 2, true,
         [](const CompensatorRow& r) { return 1000 * r.oscillation_peak_to_peak_m; }},
        {"stiffness", "stiffness felt / true stiffness", 3, false,
         [](const CompensatorRow& r) { return r.rendered_stiffness; }},
        {"drift", "distance between hand and needle (mm at the needle)", 2, true,
         [](const CompensatorRow& r) { return 1000 * r.drift_needle_m; }}};
    return measures;
}

std::vector<FigureSource> delay_figures(const std::vector<CompensatorRow>& rows) {
    std::vector<FigureSource> sources;
    if (plain_in(rows).size() < 2) return sources;
    sources.reserve(compensator_measures().size());
    for (const CompensatorMeasure& measure : compensator_measures()) {
        const std::string name = "compensators_" + std::string(measure.name);
        sources.push_back(
            {name, std::string(measure.label),
             fmt::format(
                 "Means over n = {} trials per point. A point is missing if no trial has this measure.",
                 trials_each(rows)),
             measure_data(rows, measure), measure_script(rows, measure, name)});
    }
    return sources;
}

FigureSource matrix_figure(const std::vector<CompensatorRow>& rows) {
    HeatMap map{{},
                conditions_in(rows),
                matrix_cells(rows),
                "delay of the force path, one way",
                fmt::format("trials (n = {}) that did not complete or oscillated", trials_each(rows)),
                "maximum penetration (mm), stiffness felt / true stiffness",
                kVermillion};
    for (const CompensatorNetwork& network : networks_in(rows))
        map.columns.push_back(boost::replace_all_copy(network.name, " + ", "\n+ "));
    FigureSource figure = heat_map_figure(map, "compensators_matrix");
    figure.title = "Stability, and its cost";
    figure.caption = fmt::format(
        "In each cell: maximum penetration in mm, and stiffness felt / true stiffness; means over n = {} "
        "trials (-: no trial was still). The darker a cell, the more trials oscillated or were not "
        "completed.",
        trials_each(rows));
    return figure;
}

std::vector<std::string> conditions_in(const std::vector<CompensatorRow>& rows) {
    std::vector<std::string> names;
    for (const CompensatorRow& row : rows) {
        if (std::find(names.begin(), names.end(), row.name) == names.end()) names.push_back(row.name);
    }
    return names;
}

std::vector<CompensatorNetwork> networks_in(const std::vector<CompensatorRow>& rows) {
    std::vector<CompensatorNetwork> networks;
    for (const CompensatorRow& row : rows) {
        const bool known =
            std::any_of(networks.begin(), networks.end(),
                        [&](const CompensatorNetwork& network) { return network.name == row.network.name; });
        if (!known) networks.push_back(row.network);
    }
    return networks;
}

const CompensatorRow* find_row(const std::vector<CompensatorRow>& rows, std::string_view condition,
                               std::string_view network) {
    const auto found = std::find_if(rows.begin(), rows.end(), [&](const CompensatorRow& row) {
        return row.name == condition && row.network.name == network;
    });
    return found != rows.end() ? &*found : nullptr;
}

}  // namespace thimble
