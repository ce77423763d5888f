// thimble swarm: drawn sessions with drawn faults in virtual time, every invariant of docs/safety.md watched.
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/command_line.hpp"
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
        fmt::print("{} cases from seed {} on, {:.0f} s of simulated sessions: {} broke a safety rule{}\n",
                   result.cases, a.options.seed, result.simulated_s, result.failures.size(),
                   result.complete ? "" : " (not all cases ran)");
    }
    if (!a.json && !result.failures.empty()) fmt::print("results: {}\n", a.options.out.string());
    const bool good = result.complete && result.failures.empty();
    return static_cast<int>(good ? ExitCode::kOk : ExitCode::kRunFailed);
}

}  // namespace

Subcommand add_swarm(CLI::App& app) {
    const auto arguments = std::make_shared<SwarmArguments>();
    SwarmOptions& o = arguments->options;
    CLI::App* swarm =
        app.add_subcommand("swarm", "test the safety rules in sessions with random settings and faults");
    swarm->add_option("-s,--seed", o.seed, "seed of the first case; a seed determines the whole case")
        ->capture_default_str();
    swarm->add_option("--cases", o.cases, "number of cases; each has the next seed")
        ->check(CLI::Range(1, 1'000'000'000))
        ->capture_default_str();
    add_jobs_option(*swarm, o.jobs);
    swarm
        ->add_option("-o,--out", o.out,
                     "folder for failures: for each one the smallest session file that still fails")
        ->default_val("out/swarm")
        ->type_name("FOLDER");
    swarm
        ->add_option("--plugin", o.plugin,
                     "also test the controller in this file (shared library or Python), in one of ten cases "
                     "(docs/howto/controller.md)")
        ->type_name("FILE");
    swarm->add_flag("--json", arguments->json,
                    "print counts and failures as JSON on stdout, instead of text");
    swarm->footer(
        "Examples:\n  thimble swarm --cases 2000\n  thimble swarm --seed 4711\n"
        "Exit code 1 if a session breaks a rule. docs/safety.md lists the rules, docs/reliability.md the "
        "cases that were run.");
    return {swarm, [arguments] { return run(*arguments); }};
}

}  // namespace thimble
