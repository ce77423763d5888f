// Which cell is which, and what an axis may be.
#include "study/maps/map_grid.hpp"

#include <algorithm>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/text_file.hpp"
#include "study/maps/cells.hpp"
#include "study/maps/map_options.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

using testing::ElementsAre;

MapGrid small_grid() {
    MapGrid grid;
    grid.hands = {named_hand("A"), named_hand("D")};
    grid.compensators = {"none", "wave", "scaled"};
    grid.jitters_s = {0, 0.005};
    grid.losses = {0};
    grid.delays_s = {0, 0.01, 0.05};
    grid.stiffness_N_per_m = {100, 1000};
    return grid;
}

TEST(MapGrid, EveryCellIsAnotherOneAndPanelsAreStretches) {
    const MapGrid grid = small_grid();
    ASSERT_EQ(grid.cells(), 2U * 3 * 2 * 3 * 2);
    std::set<std::string> seen;
    for (std::size_t cell = 0; cell < grid.cells(); ++cell) {
        const CellPlace p = place_of(grid, cell);
        seen.insert(std::to_string(p.hand) + std::to_string(p.compensator) + std::to_string(p.jitter) +
                    std::to_string(p.loss) + std::to_string(p.delay) + std::to_string(p.stiffness));
        EXPECT_EQ(p.hand, cell / (grid.cells() / 2));
        EXPECT_EQ(p.stiffness, cell % 2);
    }
    EXPECT_EQ(seen.size(), grid.cells());
}

TEST(MapGrid, AxesAreRangesOrValues) {
    EXPECT_THAT(parse_map_axis("--x", "0:0.2:3", false), ElementsAre(0, 0.1, 0.2));
    EXPECT_THAT(parse_map_axis("--x", "1:100:3", true), ElementsAre(1, 10, 100));
    EXPECT_THAT(parse_map_axis("--x", "0.05,0", false), ElementsAre(0.05, 0));
    for (const char* text :
         {"", "x", "1,", "1;2", "1:2", "2:1:3", "1:2:1", "1:2:3:4", "nan", "1,inf", "1:2:99999"})
        EXPECT_THROW(parse_map_axis("--x", text, false), Error) << text;
    EXPECT_THROW(parse_map_axis("--x", "0:1:3", true), Error);
}

TEST(MapGrid, WhatNoCellCouldBeMadeOfIsRefused) {
    EXPECT_NO_THROW(require_meaningful(small_grid()));
    const auto refused = [](const auto& change) {
        MapGrid grid = small_grid();
        change(grid);
        EXPECT_THROW(require_meaningful(grid), Error);
    };
    refused([](MapGrid& g) { g.compensators = {"magic"}; });
    refused([](MapGrid& g) { g.compensators = {"CF"}; });
    refused([](MapGrid& g) { g.losses = {0.6}; });
    refused([](MapGrid& g) { g.delays_s = {-0.01}; });
    refused([](MapGrid& g) { g.stiffness_N_per_m = {0}; });
    refused([](MapGrid& g) { g.hands[0].hand.mass_kg = 0; });
    EXPECT_THROW(named_hand("F"), Error);
    SweepArguments massless;
    massless.own_mass_kg = 0;
    EXPECT_THROW(grid_of(massless), Error);
}

// The virtual operator's session says how it presses on which handle.
TEST(MapGrid, ThePressIsAPassiveHands) {
    MapGrid grid = small_grid();
    EXPECT_NE(grid_text(grid).find(", press 5 N, "), std::string::npos);
    grid.who = MapOperator::kVirtual;
    EXPECT_EQ(grid_text(grid).find("press"), std::string::npos);
}

// Its rows would be others, so --resume refuses it.
TEST(MapGrid, ASessionGivesItsSeedAndTheFilesThatItNames) {
    const TemporaryDirectory directory;
    SweepArguments arguments;
    arguments.who = "virtual";
    arguments.session = (directory / "session.toml").string();
    write_text(arguments.session, "[session]\nseed = 7\n[slave_sim]\nscene = 'scene.toml'\n");
    write_text(directory / "scene.toml", "[tissue]\n[fixture]\n");
    const MapGrid grid = grid_of(arguments);
    EXPECT_EQ(grid.seed, 7U);
    const std::string before = grid_text(grid);
    write_text(directory / "scene.toml", "[tissue]\ndamping_Ns_per_m = 4\n[fixture]\n");
    EXPECT_NE(grid_text(grid), before);
    arguments.seed = 8;
    EXPECT_EQ(grid_of(arguments).seed, 8U);
    arguments.compensators = {"plugin"};
    EXPECT_THROW(grid_of(arguments), Error) << "the session names no plug-in";
}

TEST(MapCells, RowsDoNotDependOnTheBlocksTheyAreMadeIn) {
    const MapGrid grid = small_grid();
    const std::string whole = CellWriter(grid).rows({0, 4});
    std::string parts;
    for (std::size_t cell = 0; cell < 4; ++cell) parts += CellWriter(grid).rows({cell, 1});
    EXPECT_EQ(parts, whole);
}

TEST(MapCells, EveryRowHasTheHeadersColumns) {
    const auto commas = [](const std::string& text) { return std::count(text.begin(), text.end(), ','); };
    const MapGrid grid = small_grid();
    CellWriter writer(grid);
    for (const std::size_t cell : {0U, 6U, 12U})
        EXPECT_EQ(commas(writer.rows({cell, 1})), commas(cells_header())) << cell;
}

// The age of the position behind the acting force is known where the delay alone makes it.
TEST(MapCells, AVirtualOperatorsEffectiveDelayIsEmptyWhereNothingMeasuresIt) {
    MapGrid grid;
    grid.who = MapOperator::kVirtual;
    grid.hands = {{"virtual", {1, 0, 0}}};
    grid.compensators = {"none", "CF"};
    grid.jitters_s = {0, 0.005};
    grid.losses = {0};
    grid.delays_s = {0.01};
    grid.stiffness_N_per_m = {100};
    std::istringstream table(cells_header() + CellWriter(grid).rows({0, 3}));
    std::vector<std::string> delays;
    for (std::string line; std::getline(table, line);) {
        std::vector<std::string_view> fields;
        split_at(',', line, fields);
        delays.emplace_back(fields.at(16));
    }
    EXPECT_THAT(delays, ElementsAre("effective_delay_s", "0.0105", "", ""));
}

}  // namespace
}  // namespace thimble
