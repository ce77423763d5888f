// The whole board: every row that is not there yet, then the page.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>

#include "analysis/report/report.hpp"
#include "common/csv/csv_file.hpp"
#include "study/board/board_row.hpp"

namespace thimble {

struct BoardOptions {
    std::filesystem::path out;
    IfExists if_exists = IfExists::kRefuse;
    unsigned jobs = 0;  // threads; 0: one per core
    const std::atomic<bool>* stop = nullptr;
};

// Writes board.csv, a row as soon as all before it are done, and board.txt, the plan. False if it was stopped before the last row.
bool run_board(const BoardPlan& plan, const BoardOptions& options);

}  // namespace thimble
