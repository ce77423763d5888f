#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "analysis/text/gnuplot.hpp"
#include "common/error.hpp"
#include "study/maps/map_options.hpp"

namespace thimble {
namespace {

constexpr std::size_t kMostPanels = 36;

std::string whole_table(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    return text.erase(0, text.find('\n') + 1);
}

std::string title_of(const MapGrid& g, std::size_t panel) {
    const CellPlace p = place_of(g, panel * g.panel());
    std::string title = g.who == MapOperator::kVirtual ? "virtual operator" : "hand " + g.hands[p.hand].name;
    if (g.compensators.size() > 1 || g.compensators[0] != "none")
        title += ", " + g.compensators[p.compensator];
    if (g.jitters_s.size() > 1 || g.jitters_s[0] > 0)
        title += fmt::format(", jitter {:g} ms", 1e3 * g.jitters_s[p.jitter]);
    if (g.losses.size() > 1 || g.losses[0] > 0) title += fmt::format(", loss {:g} %", 100 * g.losses[p.loss]);
    return title;
}

// Rows of the table by number: every panel is a stretch of it.
std::string panel_script(const MapGrid& g, std::size_t panel, double point) {
    const std::size_t first = panel * g.panel(), last = first + g.panel() - 1;
    const std::string rows = fmt::format("'map.tsv' every ::{}::{} using", first, last);
    const auto points = [&](char label, std::string_view colour, const char* title) {
        return fmt::format(
            "     {} (1e3*$6):(strcol(12) eq '{}' ? $8 : 1/0) with points pt 5 ps {:.2f} lc rgb '{}' title "
            "'{}', \\\n",
            rows, label, point, colour, title);
    };
    return fmt::format("set title '{}'\nplot \\\n", title_of(g, panel)) + points('S', kSkyBlue, "settles") +
           points('M', kGrey, "in between") + points('O', kVermilion, "oscillates") +
           fmt::format("     {} (1e3*$6):9 with lines lw 2 lc rgb 'black' title 'theory'\n", rows);
}

std::string map_script(const MapGrid& g) {
    const std::size_t panels = g.panels();
    const auto columns = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(panels))));
    const std::size_t rows = (panels + columns - 1) / columns;
    const int width = panels == 1 ? 900 : static_cast<int>(460 * columns),
              height = panels == 1 ? 620 : static_cast<int>(360 * rows);
    // Points that touch: the width of a panel for all of them.
    const double point = (panels == 1 ? 45.0 : 20.0) /
                         static_cast<double>(std::max(g.delays_s.size(), g.stiffness_N_per_m.size()));
    const auto [low, high] = std::minmax_element(g.stiffness_N_per_m.begin(), g.stiffness_N_per_m.end());
    std::string script = gnuplot_preamble("map", width, height);
    script += fmt::format(
        "set datafile separator ','\nset logscale y\nset xlabel 'delay (ms)'\n"
        "set ylabel 'contact stiffness at the handle (N/m)'\n"
        "set yrange [{}:{}]\nset key outside bottom center horizontal\n",
        *low * (*low == *high ? 0.5 : 1), *high * (*low == *high ? 2 : 1));
    if (panels > 1) script += fmt::format("set multiplot layout {},{}\n", rows, columns);
    for (std::size_t panel = 0; panel < panels; ++panel) script += panel_script(g, panel, point);
    if (panels > 1) script += "unset multiplot\n";
    return script;
}

}  // namespace

void draw_map(const std::filesystem::path& folder, const MapGrid& grid) {
    if (grid.panels() > kMostPanels) {
        spdlog::info("no figure: {} panels are more than {}; map.csv has them all", grid.panels(),
                     kMostPanels);
        return;
    }
    try {
        run_gnuplot(folder, "map", whole_table(folder / "map.csv"), map_script(grid));
        fmt::print("figure: {}\n", (folder / "map.svg").string());
    } catch (const Error& error) {
        spdlog::warn("no figure: {}", error.what());
    }
}

}  // namespace thimble
