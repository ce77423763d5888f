#include "analysis/figures/cell_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <boost/algorithm/string/replace.hpp>
#include <fmt/format.h>

#include "analysis/figures/figure_grid.hpp"
#include "common/math/portable.hpp"

namespace thimble {
namespace {

struct CellEdges {
    double low = 0, high = 0;
};

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr const char* kCurve = "with lines linewidth 2 linecolor 'black'";
constexpr const char* kMark = "with lines dashtype 2 linewidth 1.5 linecolor 'black'";

// Half-way to the neighbours; the outer ones reach as far out as in, though not below `least`. A value without neighbours
// reaches `alone` to either side.
std::vector<CellEdges> edges_between(const std::vector<double>& values, double least, double alone) {
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
    std::vector<CellEdges> edges;
    edges.reserve(values.size());
    for (const double value : values) {
        const auto at = std::lower_bound(sorted.begin(), sorted.end(), value);
        const bool first = at == sorted.begin(), last = at + 1 == sorted.end();
        double below = alone, above = alone;
        if (!first) below = above = (value - *(at - 1)) / 2;
        if (!last) above = (*(at + 1) - value) / 2;
        if (first && !last) below = above;
        edges.push_back({std::max(least, value - below), value + above});
    }
    return edges;
}

std::vector<CellEdges> edges_of(std::vector<double> values, bool logarithmic) {
    const double lowest = *std::min_element(values.begin(), values.end());
    // No cell below zero unless a value lies there.
    if (!logarithmic)
        return edges_between(values, lowest < 0 ? -kInfinite : 0, lowest == 0 ? 1 : 0.1 * std::abs(lowest));
    for (double& value : values) value = portable::log(value);
    std::vector<CellEdges> edges = edges_between(values, -kInfinite, portable::log(1.3));
    for (CellEdges& cell : edges) cell = {portable::exp(cell.low), portable::exp(cell.high)};
    return edges;
}

// Two blocks per panel: cells (x, y, their edges, class) and the curve.
std::string map_data(const CellMap& map) {
    const auto x = edges_of(map.x, false), y = edges_of(map.y, map.logarithmic_y);
    std::string data;
    for (const CellMapPanel& panel : map.panels) {
        data += "# x, y, edges of x, edges of y, class\n";
        for (std::size_t i = 0; i < x.size(); ++i) {
            for (std::size_t j = 0; j < y.size(); ++j) {
                for (const double value : {map.x[i], map.y[j], x[i].low, x[i].high, y[j].low, y[j].high})
                    write_cell(data, value);
                data += fmt::format("{}\n", panel.labels[i * y.size() + j]);
            }
        }
        data += "\n\n# x, curve\n";
        for (std::size_t i = 0; i < x.size(); ++i) {
            // One place alone makes no line: there it crosses the cell.
            for (const double place :
                 x.size() > 1 ? std::vector{map.x[i]} : std::vector{x[i].low, x[i].high}) {
                write_cell(data, place);
                write_cell(data, std::isfinite(panel.curve[i]) ? panel.curve[i] : std::nan(""));
                data.back() = '\n';
            }
        }
        data += "\n\n";
    }
    return data;
}

// Few values are named themselves; gnuplot chooses numbers for many.
std::string axis(char name, const std::vector<double>& values, bool logarithmic) {
    constexpr std::size_t kFew = 4;
    const auto edges = edges_of(values, logarithmic);
    double low = edges[0].low, high = edges[0].high;
    for (const CellEdges& cell : edges) {
        low = std::min(low, cell.low);
        high = std::max(high, cell.high);
    }
    std::string tics = "autofreq";
    if (values.size() <= kFew) {
        tics = "(";
        for (std::size_t i = 0; i < values.size(); ++i)
            tics += fmt::format("{}{:.6g}", i > 0 ? ", " : "", values[i]);
        tics += ")";
    }
    return fmt::format("set {0}range [{1:.8g}:{2:.8g}]; set {0}tics {3}\n", name, low, high, tics);
}

int title_height_px(const CellMap& map) {
    std::ptrdiff_t lines = 0;
    for (const CellMapPanel& panel : map.panels) {
        if (panel.title.empty()) continue;
        lines = std::max(lines, 1 + std::count(panel.title.begin(), panel.title.end(), '\n'));
    }
    return 22 * static_cast<int>(lines);
}

FigureGrid layout(const CellMap& map) {
    FigureGrid grid;
    grid.columns = std::min(map.columns, map.panels.size());
    grid.rows = (map.panels.size() + grid.columns - 1) / grid.columns;
    const bool alone = map.panels.size() == 1;
    grid.panel_width_px = alone ? 700 : 300;
    grid.panel_height_px = alone ? 400 : 200;
    grid.left_px = 96;
    grid.between_px = 30;
    const int title_px = title_height_px(map);
    grid.beneath_px = 24 + title_px;
    grid.head_px = 18 + title_px;
    for (const CellClass& of : map.classes)
        grid.entries.push_back(
            {fmt::format("with boxes fillstyle solid noborder linecolor '{}'", of.colour), of.title});
    grid.entries.push_back({kCurve, map.curve_title});
    for (const auto& [y, title] : map.marks) grid.entries.push_back({kMark, title});
    return grid;
}

std::string panel_script(const CellMap& map, std::size_t index, const std::string& name) {
    std::string script =
        fmt::format("set title \"{}\"\nplot ", boost::replace_all_copy(map.panels[index].title, "\n", "\\n"));
    for (const CellClass& of : map.classes) {
        script += fmt::format(
            "'{}.tsv' index {} using 1:(strcol(7) eq '{}' ? $2 : 1/0):3:4:5:6 with boxxyerror fillstyle "
            "solid "
            "noborder linecolor '{}', \\\n     ",
            name, 2 * index, of.label, of.colour);
    }
    script += fmt::format("'{}.tsv' index {} using 1:2 smooth unique {}", name, 2 * index + 1, kCurve);
    for (const auto& [y, title] : map.marks) script += fmt::format(", \\\n     {:.6g} {}", y, kMark);
    return script + "\n";
}

std::string map_script(const CellMap& map, const std::string& name) {
    const FigureGrid grid = layout(map);
    std::string script = gnuplot_preamble(name, grid.width_px(), grid.height_px());
    script += fmt::format("{}{}{}unset key\nset multiplot\n", map.logarithmic_y ? "set logscale y\n" : "",
                          axis('x', map.x, false), axis('y', map.y, map.logarithmic_y));
    for (std::size_t i = 0; i < map.panels.size(); ++i) {
        const bool left = i % grid.columns == 0, lowest = i + grid.columns >= map.panels.size();
        script += grid.margins(i / grid.columns, i % grid.columns);
        script += fmt::format(
            "set ylabel '{}'; set format y '{}'; set xlabel '{}' offset 0,0.6; set format x '{}'\n",
            left ? map.y_label : "", left ? "%g" : "", lowest ? map.x_label : "", lowest ? "%g" : "");
        script += panel_script(map, i, name);
    }
    return script + grid.key() + "unset multiplot\n";
}

}  // namespace

std::vector<CellClass> outcome_classes() {
    return {{'S', kSkyBlue, "settles"}, {'M', kGrey, "in between"}, {'O', kVermillion, "oscillates"}};
}

FigureSource cell_map_figure(const CellMap& map, const std::string& name) {
    return {name, "", "", map_data(map), map_script(map, name)};
}

}  // namespace thimble
