#include <algorithm>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "study/maps/map_options.hpp"
#include "study/maps/map_table.hpp"

namespace thimble {

std::size_t block_of(const SweepArguments& arguments, const MapGrid& grid, std::size_t hands) {
    if (arguments.block > 0) return arguments.block;
    constexpr std::size_t kBlocksEach = 8, kMost = 128;
    if (grid.who == MapOperator::kVirtual) return 1;
    return std::clamp<std::size_t>(grid.cells() / (hands * kBlocksEach), 1, std::min(kMost, grid.column()));
}

int run_map(const SweepArguments& arguments, const MapGrid& grid, WorkerPool& pool) {
    const std::filesystem::path folder = arguments.out;
    const IfExists fresh = arguments.overwrite ? IfExists::kReplace : IfExists::kRefuse;
    MapTable table(folder, grid, arguments.resume ? IfExists::kContinue : fresh);
    if (table.done() > 0) spdlog::info("{} of {} cells were there already", table.done(), grid.cells());
    PoolWork work;
    work.first = table.done();
    work.end = grid.cells();
    work.block = block_of(arguments, grid, pool.hands());
    CellWriter writer(grid);
    work.rows = [&writer](const CellRange& range) { return writer.rows(range); };
    work.take = [&table](const CellRange& range, std::string rows) { table.take(range, std::move(rows)); };
    work.stop = &stop_requested();
    pool.lead(work);
    if (table.done() < grid.cells()) {
        spdlog::error("interrupted; the {} cells that were done are kept: go on with --resume", table.done());
        return static_cast<int>(ExitCode::kRunFailed);
    }
    fmt::print("table: {}\n", (folder / "map.csv").string());
    draw_map(folder, grid);
    return static_cast<int>(ExitCode::kOk);
}

}  // namespace thimble
