// The board on one page: who is dominated by whom, who is stable where, and each row that fails, with the command that shows why.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/report/report.hpp"
#include "study/board/pareto.hpp"

namespace thimble {

FigureSource pareto_figure(const std::vector<Contestant>& contestants);
// Writes board.html, board.json, figures/, and into sessions/ the session of each row that fails. Throws Error (run failed).
void write_board_report(const BoardPlan& plan, const std::vector<BoardRow>& rows, const std::string& command,
                        const Provenance& made_with, const std::filesystem::path& out);

}  // namespace thimble
