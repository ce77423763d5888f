// thimble board: controllers and codecs, built in or plugged in, in one table.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/process/sandbox.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "study/board/board_report.hpp"
#include "study/board/board_row.hpp"
#include "study/board/plugin_check.hpp"
#include "study/ranks/ranks.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/commands/shared.hpp"

namespace thimble {
namespace {

constexpr std::uint32_t kQuickTrials = 5;

struct BoardArguments {
    std::string out = "out/board";
    std::vector<std::string> plugins, only;
    std::uint64_t seed = 1;
    unsigned jobs = 0;
    std::string check;
    IfExists if_exists = IfExists::kRefuse;
    bool quick = false, sandbox = false, json = false;
};

BoardPlan plan_of(const BoardArguments& a) {
    BoardPlan plan = read_board(board_folder());
    plan.seed = a.seed;
    if (a.quick) plan.trials = kQuickTrials;
    for (const std::string& file : a.plugins) add_plugin(plan, file);
    keep_only(plan, a.only);
    return plan;
}

// The command that gives the same results, without the output folder.
std::string board_command(const BoardArguments& a) {
    std::string command = "thimble board";
    if (a.quick) command += " --quick";
    for (const std::string& file : a.plugins) command += " --plugin " + file;
    if (!a.only.empty()) command += fmt::format(" --only {}", fmt::join(a.only, ","));
    return command + fmt::format(" --seed {}", a.seed);
}

void say_ranks(const std::vector<BoardRow>& rows) {
    for (const Contestant& one : rank_contestants(rows))
        fmt::print("{:<26} front {}  stable in {} of {}\n", one.name,
                   one.front > 0 ? std::to_string(one.front) : "-", one.stable_rows, one.rows);
}

// 1 if a contestant did not come to its end in some row.
int say_failures(const std::vector<BoardRow>& rows) {
    int code = static_cast<int>(ExitCode::kOk);
    for (const BoardRow& row : rows) {
        if (row.status == "ok" || !row.possible()) continue;
        spdlog::error("{}, {}, {}: {}", row.controller, row.codec, row.condition, row.status);
        code = static_cast<int>(ExitCode::kRunFailed);
    }
    return code;
}

int check(const BoardArguments& a) {
    const PluginCheck found = check_plugin(a.check);
    fmt::print("{}\n", a.json ? found.json() : found.text());
    return found.exit_code();
}

// Before anything is written or loaded.
void enter_sandbox_of(const BoardArguments& a) {
    if (!a.sandbox || in_sandbox()) return;
    if (const std::string why = why_no_sandbox(); !why.empty())
        throw Error(ExitCode::kUsage, "--sandbox: {}", why);
    std::vector<std::string> files = a.plugins;
    if (!a.check.empty()) files.push_back(a.check);
    std::vector<std::filesystem::path> folders(files.size());
    std::transform(files.begin(), files.end(), folders.begin(),
                   [](const std::string& file) { return std::filesystem::absolute(file).parent_path(); });
    enter_sandbox({a.out}, folders);
}

int board(const BoardArguments& a) {
    enter_sandbox_of(a);
    if (!a.check.empty()) return check(a);
    const BoardPlan plan = plan_of(a);
    install_stop_signals();
    const BoardOptions options{join_ranks(a.out), a.if_exists, a.jobs, &stop_requested()};
    const bool complete = run_board(plan, options);
    if (own_rank() > 0) return static_cast<int>(ExitCode::kOk);
    if (!complete) {
        spdlog::error("interrupted: the finished rows are saved; continue with --resume");
        return static_cast<int>(ExitCode::kRunFailed);
    }
    const std::vector<BoardRow> rows = read_board_rows(options.out / "board.csv");
    write_board_report(plan, rows, board_command(a), {{"commit", source_commit()}}, options.out);
    say_ranks(rows);
    fmt::print("results: {}\n", (options.out / "board.html").string());
    return say_failures(rows);
}

void add_options(CLI::App& sub, BoardArguments& a) {
    sub.add_option("-o,--out", a.out, "folder for board.html, board.csv, board.json and figures/")
        ->capture_default_str()
        ->type_name("FOLDER");
    sub.add_flag("--quick", a.quick, "run 5 trials for each row instead of 30");
    sub.add_option(
           "--plugin", a.plugins,
           "also compare the controller in this file (shared library or Python); may be given several times")
        ->allow_extra_args(false)
        ->type_name("FILE");
    CLI::Option* const checked =
        sub.add_option(
               "--check", a.check,
               "compare nothing; test whether the controller in this file (shared library or Python) keeps "
               "the rules of thimble/controller.h")
            ->type_name("FILE");
    sub.add_flag("--json", a.json, "print the results of --check as JSON on stdout, instead of text")
        ->needs(checked);
    sub.add_flag("--sandbox", a.sandbox,
                 "run plug-ins inside bubblewrap: they can write only to the folder of --out, and have no "
                 "network, no /run and no /tmp");
    sub.add_option("--only", a.only,
                   "compare only these controllers, codecs and conditions, e.g. HF,wave,50ms")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->type_name("NAME,...");
    as_session_seed(sub.add_option("-s,--seed", a.seed, "seed of subjects, fixtures and networks"))
        ->capture_default_str();
    add_jobs_option(sub, a.jobs);
    add_resume_options(sub, a.if_exists, "board");
}

}  // namespace

Subcommand add_board(CLI::App& app) {
    const auto arguments = std::make_shared<BoardArguments>();
    CLI::App* sub = app.add_subcommand(
        "board", "compare controllers and codecs, built in or your own, in the same conditions");
    add_options(*sub, *arguments);
    sub->footer(
        "Prints one line per contestant: its Pareto front (1: no other one is better in everything) and the "
        "number of conditions in which it is stable.\n"
        "Examples:\n  thimble board --out out/board\n"
        "  thimble board --quick --seed 7 --out out/quick\n"
        "  thimble board --check ./mine.so\n"
        "  thimble board --plugin ./mine.so --only mine,wave --out out/mine\n"
        "Manual: docs/howto/controller.md");
    return {sub, [arguments] { return board(*arguments); }, true};
}

}  // namespace thimble
