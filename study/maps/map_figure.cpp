#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <boost/algorithm/string/split.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "analysis/figures/cell_map.hpp"
#include "analysis/text/gnuplot.hpp"
#include "common/error.hpp"
#include "study/maps/map_options.hpp"

namespace thimble {
namespace {

constexpr std::size_t kMostPanels = 36;

// Two lines: whose loop, over which network.
std::string title_of(const MapGrid& g, const CellPlace& p) {
    std::string title = g.who == MapOperator::kVirtual ? "virtual operator" : "hand " + g.hands[p.hand].name;
    if (g.compensators.size() > 1 || g.compensators[0] != "none")
        title += ", " + g.compensators[p.compensator];
    std::string network;
    if (g.jitters_s.size() > 1 || g.jitters_s[0] > 0)
        network = fmt::format("jitter {:g} ms", 1e3 * g.jitters_s[p.jitter]);
    if (g.losses.size() > 1 || g.losses[0] > 0)
        network += fmt::format("{}loss {:g} %", network.empty() ? "" : ", ", 100 * g.losses[p.loss]);
    return title + (network.empty() ? "" : "\n" + network);
}

// Panels that differ in what varies last stand beside each other, as long as a page has room for them.
std::size_t columns_of(const MapGrid& g) {
    constexpr std::size_t kMostColumns = 6;
    const std::size_t networks = g.jitters_s.size() * g.losses.size();
    for (const std::size_t columns : {g.compensators.size() * networks, networks, g.losses.size()}) {
        if (columns > 1 && columns <= kMostColumns && columns < g.panels()) return columns;
    }
    return static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(g.panels()))));
}

double number_or_nan(const std::string& text) {
    double value = std::nan("");
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

// The outcome's letter and the theory's stiffness of each row of the table; a cell that has no such field has none.
void read_outcomes(const std::filesystem::path& table, CellMap& map) {
    constexpr std::size_t kCritical = 8, kOutcome = 11;
    std::ifstream file(table);
    std::string line;
    std::getline(file, line);
    for (CellMapPanel& panel : map.panels) {
        for (std::size_t i = 0; i < map.x.size(); ++i) {
            double critical = std::nan("");
            for (std::size_t j = 0; j < map.y.size() && std::getline(file, line); ++j) {
                std::vector<std::string> fields;
                boost::split(fields, line, [](char c) { return c == ','; });
                fields.resize(std::max(fields.size(), kOutcome + 1));
                panel.labels.push_back(fields[kOutcome].empty() ? '-' : fields[kOutcome][0]);
                critical = number_or_nan(fields[kCritical]);
            }
            panel.curve.push_back(critical);
        }
        panel.labels.resize(map.x.size() * map.y.size(), '-');
    }
}

FigureSource map_figure(const MapGrid& g, const std::filesystem::path& table) {
    CellMap map{"round-trip delay (ms)",
                "contact stiffness at the handle (N/m)",
                {},
                g.stiffness_N_per_m,
                true,
                outcome_classes(),
                {},
                columns_of(g),
                "theory",
                {}};
    if (g.panels() > 1) map.y_label = "contact stiffness (N/m)";
    for (const double delay_s : g.delays_s) map.x.push_back(1e3 * delay_s);
    for (std::size_t panel = 0; panel < g.panels(); ++panel)
        map.panels.push_back({title_of(g, place_of(g, panel * g.panel())), {}, {}});
    read_outcomes(table, map);
    return cell_map_figure(map, "map");
}

}  // namespace

void draw_map(const std::filesystem::path& folder, const MapGrid& grid) {
    if (grid.panels() > kMostPanels) {
        spdlog::info("no figure: the map has {} panels, and at most {} are drawn; map.csv has all cells",
                     grid.panels(), kMostPanels);
        return;
    }
    try {
        const FigureSource figure = map_figure(grid, folder / "map.csv");
        run_gnuplot(folder, figure.name, figure.data, figure.script);
        fmt::print("figure: {}\n", (folder / "map.svg").string());
    } catch (const Error& error) {
        spdlog::warn("no figure: {}", error.what());
    }
}

}  // namespace thimble
