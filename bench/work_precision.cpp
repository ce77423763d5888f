// thimble-bench work-precision: what each tissue solver costs for which error (docs/solvers.md).
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "bench/studies.hpp"
#include "bench/work_precision/claims.hpp"
#include "bench/work_precision/figure.hpp"
#include "bench/work_precision/real_time.hpp"
#include "bench/work_precision/tables.hpp"
#include "common/process/progress.hpp"
#include "common/runtime/command_line.hpp"

namespace thimble {

namespace {

struct WorkPrecisionOptions {
    std::string out = "out/work-precision";
    std::vector<std::string> names;
    bool quick = false;
};

std::vector<const Problem*> chosen_problems(const WorkPrecisionOptions& options) {
    constexpr std::array<std::string_view, 3> kQuick{"insert_300mm_s", "underdamped", "coarse"};
    std::vector<const Problem*> chosen;
    for (const std::string& name : options.names) chosen.push_back(&problem_named(name));
    if (!chosen.empty()) return chosen;
    if (options.quick) {
        for (const std::string_view name : kQuick) chosen.push_back(&problem_named(name));
        return chosen;
    }
    for (const Problem& problem : problems()) chosen.push_back(&problem);
    return chosen;
}

std::vector<Entry> run_sweep(const std::vector<const Problem*>& chosen, bool quick, Progress& progress) {
    const std::vector<Contestant> contestants = sweep(quick);
    std::vector<Entry> entries;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        progress.show(fmt::format("problem {} of {}: {}", i + 1, chosen.size(), chosen[i]->name), true);
        for (Entry& entry : run_problem(*chosen[i], contestants, quick ? 3 : 15)) {
            entries.push_back(std::move(entry));
        }
    }
    return entries;
}

std::vector<RealTimeRow> run_rates(bool quick, Progress& progress) {
    std::vector<RealTimeRow> rows;
    for (const char* name : {"insert_100mm_s", "wall"}) {
        progress.show(fmt::format("real time: {}", name), true);
        for (RealTimeRow& row : run_real_time(problem_named(name), quick)) rows.push_back(std::move(row));
    }
    return rows;
}

int run(const WorkPrecisionOptions& options) {
    const std::vector<const Problem*> chosen = chosen_problems(options);
    const std::filesystem::path folder(options.out);
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);  // what went wrong shows when writing
    Progress progress;
    const std::vector<Entry> entries = run_sweep(chosen, options.quick, progress);
    write_entries(folder / "work_precision.csv", entries);
    const std::vector<RealTimeRow> rows = run_rates(options.quick, progress);
    write_real_time(folder / "real_time.csv", rows);
    draw_work_precision(folder, entries);
    progress.say(fmt::format("{} entries in {}", entries.size(), folder.string()));
    fmt::print("{}\n{}\n{}  each time includes reading the clock, some {:.0f} ns\n\n{}",
               comparison_table(entries), exact_table(entries), real_time_table(rows), clock_ns(),
               claims_table(judge_claims(entries, asleep_ns_per_step())));
    return 0;
}

}  // namespace

int work_precision_study(int argc, char** argv) {
    WorkPrecisionOptions options;
    CLI::App app("Speed against error of the tissue solvers, against a solution of 40 digits and more.",
                 "thimble-bench work-precision");
    app.add_option("-o,--out", options.out, "folder for work_precision.csv, real_time.csv and the figure")
        ->default_str(options.out);
    app.add_option("-p,--problem", options.names,
                   "named problems (docs/solvers.md); all of them if none is given");
    app.add_flag("--quick", options.quick, "few problems, settings and repetitions: does it run at all?");
    app.footer(
        "Example:\n  thimble-bench work-precision --problem insert_100mm_s underdamped --out "
        "out/work-precision\n\n"
        "Exit codes: 0 ok (whatever was measured), 1 failed, 2 usage.");
    if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
    return run(options);
}

}  // namespace thimble
