#include <algorithm>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/process/progress.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "study/maps/cells.hpp"
#include "study/maps/map_options.hpp"
#include "study/planned_table.hpp"
#include "study/worker_pool.hpp"

namespace thimble {

std::size_t block_of(const SweepArguments& arguments, const MapGrid& grid, std::size_t hands) {
    if (arguments.block > 0) return arguments.block;
    constexpr std::size_t kBlocksEach = 8, kMost = 128;
    if (grid.who == MapOperator::kVirtual) return 1;
    return std::clamp<std::size_t>(grid.cells() / (hands * kBlocksEach), 1, std::min(kMost, grid.column()));
}

int run_map(const SweepArguments& arguments, const MapGrid& grid) {
    const std::filesystem::path folder = arguments.out;
    PlannedTable table(folder, "map", "map", grid_text(grid), cells_header(), arguments.if_exists,
                       {"map.svg", "map.pdf", "map.tsv", "map.gp"});
    const std::size_t first = table.done();
    if (first > 0) spdlog::info("{} of {} cells were already done", first, grid.cells());
    const std::size_t block = block_of(arguments, grid, worker_count(arguments.jobs));
    CellWriter writer(grid);
    Progress progress;
    run_in_order<std::string>((grid.cells() - first + block - 1) / block, arguments.jobs, &stop_requested(),
                              [&](std::size_t i) {
                                  const std::size_t from = first + i * block;
                                  return writer.rows({from, std::min(block, grid.cells() - from)});
                              },
                              [&](const std::string& rows) {
                                  table.append(rows);
                                  progress.count(table.done(), grid.cells(), "cells", "");
                              },
                              ResultsGo::kToFirst,
                              [&] { return fmt::format("{} {} {}", first, block, grid_text(grid)); });
    if (own_rank() > 0) return static_cast<int>(ExitCode::kOk);
    progress.close();
    if (table.done() < grid.cells()) {
        spdlog::error("interrupted: {} cells are done and saved; continue with --resume", table.done());
        return static_cast<int>(ExitCode::kRunFailed);
    }
    draw_map(folder, grid);
    fmt::print("results: {}\n", (folder / "map.csv").string());
    return static_cast<int>(ExitCode::kOk);
}

}  // namespace thimble
