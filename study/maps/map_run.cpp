#include <algorithm>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
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
    const IfExists fresh = arguments.overwrite ? IfExists::kReplace : IfExists::kRefuse;
    PlannedTable table(folder, "map", "map", grid_text(grid), cells_header(),
                       arguments.resume ? IfExists::kContinue : fresh);
    const std::size_t first = table.done();
    if (first > 0) spdlog::info("{} of {} cells were there already", first, grid.cells());
    const std::size_t block = block_of(arguments, grid, worker_count(arguments.jobs));
    CellWriter writer(grid);
    run_in_order<std::string>((grid.cells() - first + block - 1) / block, arguments.jobs, &stop_requested(),
                              [&](std::size_t i) {
                                  const std::size_t from = first + i * block;
                                  return writer.rows({from, std::min(block, grid.cells() - from)});
                              },
                              [&](const std::string& rows) { table.append(rows); }, ResultsGo::kToFirst,
                              fmt::format("{} {} {}", first, block, grid_text(grid)));
    if (own_rank() > 0) return static_cast<int>(ExitCode::kOk);
    if (table.done() < grid.cells()) {
        spdlog::error("interrupted; the {} cells that were done are kept: go on with --resume", table.done());
        return static_cast<int>(ExitCode::kRunFailed);
    }
    fmt::print("table: {}\n", (folder / "map.csv").string());
    draw_map(folder, grid);
    return static_cast<int>(ExitCode::kOk);
}

}  // namespace thimble
