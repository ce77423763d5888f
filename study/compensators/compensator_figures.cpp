#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "analysis/text/gnuplot.hpp"
#include "study/compensators/compensator_report.hpp"

namespace thimble {
namespace {

// Modalities dark and dashed, compensators in colour; what shares a colour differs in dash and point.
struct LineStyle {
    std::string_view condition, colour;
    int dash, point;
};
constexpr std::string_view kInk = "#000000", kOrange = "#E69F00";
constexpr std::array kStyles{LineStyle{"HF", kInk, 1, 7},
                             LineStyle{"CF", kInk, 2, 6},
                             LineStyle{"CCF", kInk, 3, 4},
                             LineStyle{"VF", kGrey, 2, 8},
                             LineStyle{"scaled", kOrange, 1, 9},
                             LineStyle{"passivity", kSkyBlue, 1, 5},
                             LineStyle{"energy-bound-memoryless", kGreen, 2, 10},
                             LineStyle{"energy-bound", kGreen, 1, 11},
                             LineStyle{"two-layer", kBlue, 1, 13},
                             LineStyle{"local-fixture", kPurple, 1, 7},
                             LineStyle{"wave", kVermilion, 1, 5},
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

// A column per condition.
std::string measure_data(const std::vector<CompensatorRow>& rows, const CompensatorMeasure& measure) {
    std::string data = "# delay, then the conditions\n";
    const std::vector<std::string> conditions = conditions_in(rows);
    const std::vector<CompensatorNetwork> networks = plain_in(rows);
    for (std::size_t i = 0; i < networks.size(); ++i) {
        write_cell(data, static_cast<double>(i));
        for (const std::string& condition : conditions) {
            const CompensatorRow* const row = find_row(rows, condition, networks[i].name);
            const double value = row != nullptr ? measure.value(*row) : std::nan("");
            write_cell(data, measure.logarithmic && value <= 0 ? std::nan("") : value);
        }
        data.back() = '\n';
    }
    return data;
}

std::string measure_script(const std::vector<CompensatorRow>& rows, const CompensatorMeasure& measure,
                           const std::string& name) {
    const std::vector<CompensatorNetwork> networks = plain_in(rows);
    const std::string tics = numbered_tics(
        networks.size(), [&](std::size_t i) { return fmt::format("{:g}", 1000 * networks[i].delay_s); });
    std::string script = gnuplot_preamble(name, 860, 430);
    script += fmt::format(
        "set xtics ({})\nset xrange [-0.2:{:.1f}]\nset xlabel 'delay of the force path, one way (ms)'\n"
        "set ylabel '{}'\nset key outside right center vertical samplen 3 noenhanced\n{}plot ",
        tics, static_cast<double>(networks.size()) - 0.8, measure.label,
        measure.logarithmic ? "set logscale y\nset format y '%g'\n" : "set yrange [0:*]\n");
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

// Column, row from the top, share of trials that failed or oscillated (no more than once each), label.
std::string matrix_data(const std::vector<CompensatorRow>& rows) {
    std::string data;
    const std::vector<std::string> conditions = conditions_in(rows);
    const std::vector<CompensatorNetwork> networks = networks_in(rows);
    for (std::size_t x = 0; x < networks.size(); ++x) {
        for (std::size_t y = 0; y < conditions.size(); ++y) {
            const CompensatorRow* const row = find_row(rows, conditions[y], networks[x].name);
            if (row == nullptr || row->trials == 0) continue;
            const std::uint32_t bad = std::max(row->oscillating, row->trials - row->completed);
            data +=
                fmt::format("{}\t{}\t{:.4g}\t\"{}\"\n", x, y, 100.0 * bad / row->trials, matrix_cell(*row));
        }
        data += '\n';
    }
    return data;
}

std::string matrix_script(const std::vector<CompensatorRow>& rows, const std::string& name) {
    const std::vector<std::string> conditions = conditions_in(rows);
    const std::vector<CompensatorNetwork> networks = networks_in(rows);
    std::string x;
    for (std::size_t i = 0; i < networks.size(); ++i) {
        std::string broken = networks[i].name;
        for (std::size_t plus = broken.find(" + "); plus != std::string::npos; plus = broken.find(" + "))
            broken.replace(plus, 1, "\\n");
        x += fmt::format("{}\"{}\" {}", i > 0 ? ", " : "", broken, i);
    }
    const std::string y = numbered_tics(conditions.size(), [&](std::size_t i) { return conditions[i]; });
    std::string script = gnuplot_preamble(name, 960, 130 + 27 * static_cast<int>(conditions.size()));
    script += fmt::format(
        "set bmargin 4.5\nset xtics ({}) noenhanced\nset ytics ({}) noenhanced\nunset key\nset xrange "
        "[-0.5:{:.1f}]\n"
        "set yrange [{:.1f}:-0.5]\nset palette defined (0 '#FFFFFF', 1 '#FBE3D6', 100 '{}')\nset cbrange "
        "[0:100]\n"
        "set cblabel 'percent of trials not completed or oscillating'\n"
        "plot '{}.tsv' using 1:2:3 with image pixels, \\\n"
        "     '' using 1:2:4 with labels font ',10' textcolor '#000000'\n",
        x, y, static_cast<double>(networks.size()) - 0.5, static_cast<double>(conditions.size()) - 0.5,
        kVermilion, name);
    return script;
}

}  // namespace

bool is_stable(const CompensatorRow& row) { return row.completed == row.trials && row.oscillating == 0; }

const std::vector<CompensatorMeasure>& compensator_measures() {
    static const std::vector<CompensatorMeasure> measures{
        {"penetration", "maximum penetration (mm)", 2, true,
         [](const CompensatorRow& r) { return 1000 * r.penetration_max_m; }},
        {"completion", "completion time (s), of those completed", 1, false,
         [](const CompensatorRow& r) { return r.completion_time_s; }},
        {"oscillating", "trials that oscillate (percent)", 0, false,
         [](const CompensatorRow& r) {
             return r.trials > 0 ? 100.0 * r.oscillating / r.trials : std::nan("");
         }},
        {"movement", "needle in the hold, peak to peak (mm)", 2, true,
         [](const CompensatorRow& r) { return 1000 * r.oscillation_peak_to_peak_m; }},
        {"stiffness", "stiffness felt over the true one", 3, false,
         [](const CompensatorRow& r) { return r.rendered_stiffness; }},
        {"drift", "distance of hand and needle (mm of needle)", 2, true,
         [](const CompensatorRow& r) { return 1000 * r.drift_needle_m; }}};
    return measures;
}

std::vector<FigureSource> delay_figures(const std::vector<CompensatorRow>& rows) {
    std::vector<FigureSource> sources;
    if (plain_in(rows).size() < 2) return sources;
    sources.reserve(compensator_measures().size());
    for (const CompensatorMeasure& measure : compensator_measures()) {
        const std::string name = "compensators_" + std::string(measure.name);
        sources.push_back({name, std::string(measure.label),
                           "Means over trials. A point that is missing has no such trial.",
                           measure_data(rows, measure), measure_script(rows, measure, name)});
    }
    return sources;
}

FigureSource matrix_figure(const std::vector<CompensatorRow>& rows) {
    const std::string name = "compensators_matrix";
    return {name, "Who is stable where, and at what cost",
            "In each cell the maximum penetration in mm and the stiffness felt over the true one; the "
            "darker, the more trials were not completed or oscillated.",
            matrix_data(rows), matrix_script(rows, name)};
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
