#include "study/board/board_run.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/process/progress.hpp"
#include "study/planned_table.hpp"
#include "study/worker_pool.hpp"

namespace thimble {

bool run_board(const BoardPlan& plan, const BoardOptions& options) {
    PlannedTable table(options.out, "board", "board", plan_text(plan), board_header(), options.if_exists);
    const std::size_t first = table.done();
    if (first > 0) spdlog::info("{} of {} rows were there already", first, plan.rows());
    Progress progress;
    const auto row = [&](std::size_t i) { return board_line(run_board_row(plan, first + i)); };
    const auto take = [&](const std::string& line) {
        const std::string name = row_name(place_of(plan, table.done()));
        table.append(line);
        progress.show(fmt::format("{}/{} rows, {}", table.done(), plan.rows(), name),
                      table.done() % (plan.rows() / 10 + 1) == 0);
    };
    const bool complete =
        run_in_order<std::string>(plan.rows() - first, options.jobs, options.stop, row, take,
                                  ResultsGo::kToFirst, fmt::format("{} {}", first, plan_text(plan)));
    progress.say(fmt::format("{} of {} rows", table.done(), plan.rows()));
    return complete;
}

}  // namespace thimble
