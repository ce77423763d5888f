#include "analysis/figures/heat_map.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <boost/algorithm/string/replace.hpp>
#include <fmt/format.h>

#include "analysis/figures/figure_grid.hpp"

namespace thimble {
namespace {

constexpr int kHeatCharacter_px = 8, kHeatLine_px = 18;
constexpr int kHeatHead_px = 80;  // two lines of text, and the scale with its numbers
constexpr int kScale_px = 140;

struct TextSize {
    std::size_t longest = 0, lines = 1;
};

TextSize size_of(const std::vector<std::string>& names) {
    TextSize size;
    for (const std::string& name : names) {
        std::istringstream stream(name);
        std::size_t lines = 0;
        for (std::string line; std::getline(stream, line); ++lines)
            size.longest = std::max(size.longest, line.size());
        size.lines = std::max(size.lines, lines);
    }
    return size;
}

// Behind the longer line of the head's text.
int scale_left_px(const HeatMap& map) {
    const std::size_t longest = std::max(map.text_is.size() + 14, map.percent_of.size() + 19);
    return 24 + 7 * static_cast<int>(longest);
}

FigureGrid layout(const HeatMap& map) {
    const TextSize columns = size_of(map.columns);
    std::size_t longest_text = columns.longest;
    for (const HeatCell& cell : map.cells) longest_text = std::max(longest_text, cell.text.size());
    FigureGrid grid;
    grid.left_px = 24 + kHeatCharacter_px * static_cast<int>(size_of(map.rows).longest);
    grid.head_px = kHeatHead_px;
    grid.foot_px = 18 + kHeatLine_px * static_cast<int>(columns.lines + (map.x_label.empty() ? 0 : 1));
    grid.panel_width_px =
        (12 + kHeatCharacter_px * static_cast<int>(longest_text)) * static_cast<int>(map.columns.size());
    grid.panel_height_px = 27 * static_cast<int>(map.rows.size());
    grid.right_px = std::max(24, scale_left_px(map) + kScale_px + 30 - grid.left_px - grid.panel_width_px);
    return grid;
}

std::string map_data(const HeatMap& map) {
    std::string data = "# column, row, percent, text\n";
    for (const HeatCell& cell : map.cells)
        data += fmt::format("{}\t{}\t{:.4g}\t\"{}\"\n", cell.column, cell.row, cell.percent, cell.text);
    return data + "NaN\tNaN\tNaN\t\"\"\n";
}

std::string tics(const std::vector<std::string>& names) {
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i)
        text +=
            fmt::format("{}\"{}\" {}", i > 0 ? ", " : "", boost::replace_all_copy(names[i], "\n", "\\n"), i);
    return text;
}

// The meaning of the cells' texts and colours.
std::string head_script(const HeatMap& map, const FigureGrid& grid) {
    const double width = grid.width_px(), height = grid.height_px();
    return fmt::format(
        "set label 1 'in each cell: {}' at screen {:.4f},{:.4f} left noenhanced\n"
        "set label 2 'colour: percent of {}' at screen {:.4f},{:.4f} left noenhanced\n"
        "set colorbox horizontal user origin screen {:.4f},{:.4f} size screen {:.4f},{:.4f}\n"
        "set cbtics 0,50,100 scale 0.5 offset 0,0.4\n"
        "set label 3 '{}' at screen {:.4f},{:.4f} left noenhanced\n",
        map.text_is, 14 / width, 1 - 16 / height, map.percent_of, 14 / width, 1 - 42 / height,
        scale_left_px(map) / width, 1 - 40 / height, kScale_px / width, 14 / height, map.x_label,
        grid.left_px / width, 12 / height);
}

// So that a cell of 1 percent differs from an empty one.
Colour palest(const Colour& darkest) {
    constexpr double kShare = 0.15;
    Colour pale{};
    for (std::size_t i = 0; i < pale.size(); ++i)
        pale[i] = static_cast<std::uint8_t>(std::lround(std::lerp(255.0, darkest[i], kShare)));
    return pale;
}

std::string map_script(const HeatMap& map, const std::string& name) {
    const FigureGrid grid = layout(map);
    std::string script = gnuplot_preamble(name, grid.width_px(), grid.height_px());
    script += head_script(map, grid) + grid.margins(0, 0);
    script += fmt::format(
        "set xtics scale 0 ({}) noenhanced\nset ytics scale 0 ({}) noenhanced\nunset key\n"
        "set xrange [-0.5:{:.1f}]; set yrange [{:.1f}:-0.5]\n"
        "set palette defined (0 'white', 1 '{}', 100 '{}'); set cbrange [0:100]\n"
        "plot '{}.tsv' using 1:2:($1-0.5):($1+0.5):($2-0.5):($2+0.5):3 with boxxyerror fillstyle solid "
        "noborder fillcolor palette, \\\n"
        "     '' using 1:2:4 with labels font ',11' textcolor '#000000'\n",
        tics(map.columns), tics(map.rows), static_cast<double>(map.columns.size()) - 0.5,
        static_cast<double>(map.rows.size()) - 0.5, palest(map.darkest), map.darkest, name);
    return script;
}

}  // namespace

FigureSource heat_map_figure(const HeatMap& map, const std::string& name) {
    return {name, "", "", map_data(map), map_script(map, name)};
}

}  // namespace thimble
