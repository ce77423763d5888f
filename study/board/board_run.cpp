#include "study/board/board_run.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/process/progress.hpp"
#include "study/ordered_workers.hpp"
#include "study/planned_table.hpp"

namespace thimble {

bool run_board(const BoardPlan& plan, const BoardOptions& options) {
    PlannedTable table(options.out, "board", "board", plan_text(plan), board_header(), options.if_exists);
    const std::size_t first = table.done();
    if (first > 0) spdlog::info("{} of {} rows were there already", first, plan.rows());
    OrderedWorkers<std::string> workers(
        plan.rows() - first, thread_count(options.jobs),
        [&](std::size_t i) { return board_line(run_board_row(plan, first + i)); }, options.stop);
    Progress progress;
    while (table.done() < plan.rows()) {
        const std::string name = row_name(place_of(plan, table.done()));
        const auto line = workers.take();
        if (!line) return false;
        table.append(*line);
        progress.show(fmt::format("{}/{} rows, {}", table.done(), plan.rows(), name),
                      table.done() % (plan.rows() / 10 + 1) == 0);
    }
    progress.say(fmt::format("{} of {} rows", table.done(), plan.rows()));
    return true;
}

}  // namespace thimble
