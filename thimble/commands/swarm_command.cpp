// thimble swarm: drawn sessions with drawn faults in virtual time, every invariant of docs/safety.md watched.
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "study/study.hpp"
#include "study/swarm/swarm.hpp"
#include "thimble/commands/commands.hpp"

namespace thimble {
namespace {

struct SwarmArguments {
    SwarmOptions options;
    bool json = false;
};

int run(SwarmArguments& a) {
    install_stop_signals();
    a.options.stop = &stop_requested();
    const SwarmResult result = run_swarm(a.options);
    if (a.json) {
        fmt::print("{}", swarm_json(a.options, result));
    } else {
        for (const SwarmFailure& failure : result.failures) fmt::print("{}", failure_text(failure));
        fmt::print("{} cases from seed {} on, {:.0f} s of sessions: {} broke an invariant{}\n", result.cases,
                   a.options.seed, result.simulated_s, result.failures.size(),
                   result.complete ? "" : "; not all cases ran");
    }
    const bool good = result.complete && result.failures.empty();
    return static_cast<int>(good ? ExitCode::kOk : ExitCode::kRunFailed);
}

}  // namespace

Subcommand add_swarm(CLI::App& app) {
    const auto arguments = std::make_shared<SwarmArguments>();
    SwarmOptions& o = arguments->options;
    CLI::App* swarm = app.add_subcommand(
        "swarm", "sessions with random settings and faults, in virtual time: does every safety rule hold?");
    swarm->add_option("-s,--seed", o.seed, "of the first case; it alone decides what that case is")
        ->capture_default_str();
    swarm->add_option("-n,--trials", o.trials, "cases, each with the next seed")
        ->check(CLI::Range(1, 1'000'000'000))
        ->capture_default_str();
    swarm->add_option("-j,--jobs", o.jobs, "threads, 0: one per core; the results do not depend on it")
        ->check(CLI::Range(0, 1024));
    swarm
        ->add_option("-o,--out", o.out,
                     "folder for the smallest session file that still fails, one per failure")
        ->default_val("out/swarm");
    swarm->add_flag("--json", arguments->json, "print the counts and the failures as JSON");
    swarm->footer(
        "Examples:\n  thimble swarm --trials 2000\n  thimble swarm --seed 4711\n"
        "docs/safety.md lists the rules, docs/reliability.md says what was tried. Exit code 1 if a rule "
        "breaks.");
    return {swarm, [arguments] { return run(*arguments); }};
}

}  // namespace thimble
