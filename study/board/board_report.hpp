// The board as a page: Pareto fronts, stability, and each row that fails, with the command that reproduces it.
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "analysis/report/report.hpp"
#include "study/board/pareto.hpp"

namespace thimble {

// Wall-clock time of a millisecond of the whole session, of the calmest of three trials in the first condition.
struct BoardCost {
    std::string controller, codec;
    double median_us = 0, most_us = 0;  // most_us: of 999 in 1000
    double worst_us = std::numeric_limits<double>::infinity();
};
// Costs of the built-in controllers.
std::vector<BoardCost> measure_costs(const BoardPlan& plan);
std::string cost_csv(const std::vector<BoardCost>& costs);

FigureSource pareto_figure(const std::vector<Contestant>& contestants);
// Writes board.html, board.json, board_cost.csv, figures/, and into sessions/ the session of each row that fails.
// Throws Error (run failed).
void write_board_report(const BoardPlan& plan, const std::vector<BoardRow>& rows, const std::string& command,
                        const Provenance& made_with, const std::filesystem::path& out);

}  // namespace thimble
