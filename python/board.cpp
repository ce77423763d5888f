// thimble.board: the rows of `thimble board`, in board.csv of a folder.
#include "common/error.hpp"
#include "python/bindings.hpp"
#include "study/board/board_row.hpp"

namespace thimble {
namespace {

namespace py = pybind11;

BoardPlan plan_of(const std::string& shipped, const std::vector<std::string>& plugins,
                  const std::vector<std::string>& only, std::uint32_t trials, std::uint64_t seed) {
    constexpr std::uint32_t kMostTrials = 1'000'000;
    if (trials < 1 || trials > kMostTrials)
        throw Error(ExitCode::kUsage, "trials {}: has to be 1 to {}", trials, kMostTrials);
    BoardPlan plan = read_board(shipped);
    plan.trials = trials;
    plan.seed = seed;
    for (const std::string& file : plugins) add_plugin(plan, file);
    keep_only(plan, only);
    return plan;
}

// `shipped`: the folder of the files that say what the board has.
void board_folder_to(const std::string& shipped, const std::vector<std::string>& plugins,
                     const std::vector<std::string>& only, std::uint32_t trials, std::uint64_t seed,
                     unsigned jobs, const std::string& out, bool overwrite) {
    require_jobs(jobs);
    const BoardPlan plan = plan_of(shipped, plugins, only, trials, seed);
    std::atomic<bool> stop = false;
    const IfExists if_exists = overwrite ? IfExists::kReplace : IfExists::kRefuse;
    interruptible(stop, [&] { return run_board(plan, {out, if_exists, jobs, &stop}); });
}

}  // namespace

void add_board(py::module_& module) {
    module.def("board_folder", &board_folder_to,
               "Writes board.csv into a folder. thimble.board() is for users.");
}

}  // namespace thimble
