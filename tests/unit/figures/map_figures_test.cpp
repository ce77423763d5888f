// Maps and matrices: one column, one cell, many panels.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analysis/figures/cell_map.hpp"
#include "analysis/figures/figures.hpp"
#include "analysis/figures/heat_map.hpp"
#include "common/error.hpp"
#include "study/compensators/compensator_report.hpp"
#include "study/maps/cells.hpp"
#include "study/maps/map_options.hpp"
#include "tests/unit/analysis/gnuplot_or_none.hpp"
#include "tests/unit/figures/svg_picture.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

constexpr const char* kVermillionArea = "rgb(213,  94,   0)";

class MapPictures : public testing::Test {
  protected:
    void SetUp() override {
        if (!have_gnuplot()) GTEST_SKIP() << "gnuplot is not installed (package gnuplot-nox)";
    }
    SvgPicture drawn(const FigureSource& figure) const {
        return SvgPicture(run_gnuplot(folder_.path(), figure.name, figure.data, figure.script));
    }
    std::size_t cells(const SvgPicture& picture, const std::string& colour) const {
        std::size_t count = 0;
        for (const PictureArea& area : picture.areas()) {
            for (const PictureBox& panel : picture.panels())
                count += area.colour == colour && panel.holds(area.box) ? 1 : 0;
        }
        return count;
    }

    TemporaryDirectory folder_;
};

std::vector<CompensatorRow> compensator_rows(const std::vector<const char*>& conditions,
                                             const std::vector<CompensatorNetwork>& networks) {
    std::vector<CompensatorRow> rows;
    for (const char* condition : conditions) {
        for (const CompensatorNetwork& network : networks) {
            CompensatorRow row;
            row.name = condition;
            row.network = network;
            row.trials = row.completed = 3;
            row.oscillating = row.name == "HF" ? 3 : 0;
            row.penetration_max_m = row.name == "HF" ? 0.0326 : 0.002;
            row.rendered_stiffness = row.name == "HF" ? std::nan("") : 0.5;
            rows.push_back(row);
        }
    }
    return rows;
}

const std::vector<const char*> kConditions{"HF", "CF", "energy-bound-memoryless"};

TEST_F(MapPictures, TheMatrixOfOneDelayHasItsColours) {
    const FigureSource figure = matrix_figure(compensator_rows(kConditions, plain_networks({0.05})));
    const SvgPicture picture = drawn(figure);
    EXPECT_EQ(picture.faults(), "");
    EXPECT_EQ(cells(picture, kVermillionArea), 1U);
    EXPECT_TRUE(picture.says("trials (n = 3) that did not complete or oscillated"));
    EXPECT_TRUE(picture.says("32.6  -"));
    EXPECT_THAT(figure.caption, testing::HasSubstr("n = 3 trials"));
}

TEST_F(MapPictures, MatricesOfAnySizeAreReadable) {
    for (const auto& conditions : {std::vector<const char*>{"HF"}, kConditions}) {
        for (const auto& networks : {plain_networks({0.2}), plain_networks({0, 0.05}), standard_networks()}) {
            const SvgPicture picture = drawn(matrix_figure(compensator_rows(conditions, networks)));
            EXPECT_EQ(picture.faults(), "") << conditions.size() << " x " << networks.size();
            EXPECT_EQ(cells(picture, kVermillionArea), networks.size());
        }
    }
}

TEST_F(MapPictures, CurvesOverDelayAreReadableWithoutAnyValue) {
    auto rows = compensator_rows(kConditions, plain_networks({0, 0.05}));
    for (const bool numbers : {true, false}) {
        for (CompensatorRow& row : rows) {
            if (!numbers) row.trials = row.completed = row.oscillating = 0;
            row.penetration_max_m = numbers ? 0.002 : std::nan("");
            row.drift_needle_m = numbers ? 0 : std::nan("");
        }
        for (const FigureSource& figure : delay_figures(rows))
            EXPECT_EQ(drawn(figure).faults(), "") << figure.name << " " << numbers;
    }
}

CellMap cell_map(const std::vector<double>& x, const std::vector<double>& y, std::size_t panels) {
    CellMap map{"delay (ms)", "stiffness (N/m)", x, y, true, outcome_classes(), {}, 6, "theory", {}};
    for (std::size_t panel = 0; panel < panels; ++panel) {
        map.panels.push_back({"hand D, energy-bound-memoryless\njitter 5 ms, loss 5 %",
                              std::vector<char>(x.size() * y.size(), 'O'),
                              std::vector<double>(x.size(), panel == 0 ? HUGE_VAL : y[0])});
    }
    return map;
}

TEST_F(MapPictures, CellsStayWithinTheAxesHoweverFew) {
    for (const auto& x : {std::vector<double>{0}, std::vector<double>{50}, std::vector<double>{50, 0, 200}}) {
        for (const auto& y : {std::vector<double>{9000}, std::vector<double>{50, 1000, 20000}}) {
            for (const std::size_t panels : {1U, 8U}) {
                const SvgPicture picture = drawn(cell_map_figure(cell_map(x, y, panels), "map"));
                EXPECT_EQ(picture.faults(), "") << x.size() << " x " << y.size() << ", " << panels;
                EXPECT_EQ(cells(picture, kVermillionArea), x.size() * y.size() * panels);
                EXPECT_EQ(picture.panels().size(), panels);
            }
        }
    }
}

TEST_F(MapPictures, ASweepIsDrawnFromItsTable) {
    MapGrid grid;
    grid.hands = {named_hand("A"), named_hand("D")};
    grid.compensators = {"none"};
    grid.jitters_s = grid.losses = {0};
    grid.delays_s = {0, 0.05, 0.1};
    grid.stiffness_N_per_m = {100, 1000, 20000};
    std::ofstream(folder_ / "map.csv") << cells_header() << CellWriter(grid).rows({0, grid.cells()});
    draw_map(folder_.path(), grid);
    const SvgPicture picture(read_text(folder_ / "map.svg"));
    EXPECT_EQ(picture.faults(), "");
    EXPECT_GE(cells(picture, kVermillionArea), 6U);
    EXPECT_GE(cells(picture, "rgb( 86, 180, 233)"), 2U);
    EXPECT_TRUE(picture.says("hand D"));
}

}  // namespace
}  // namespace thimble
