// thimble-bench chain: the round trip through the five real programs beside that of bare processes over as many hops,
// window by window in one run (docs/network-relay.md).
#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "bench/network/bare_chain.hpp"
#include "bench/network/chain_figures.hpp"
#include "bench/network/chain_rounds.hpp"
#include "bench/network/study_place.hpp"
#include "bench/studies.hpp"
#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "session/virtual/ping_pong.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;

// Not of a temporary: g++ 12 then warns of members that it thinks were never set.
int default_base_port() {
    const NetworkSettings settings;
    return settings.base_port;
}

struct ChainOptions {
    int rounds = 8;
    double window_s = 1;
    int base_port = default_base_port();
    std::string programs, scheduling = "both";
    bool json = false;
};

WindowQuantiles ping_pong(const ChainSettings& settings) {
    const Histogram h =
        measure_ping_pong(settings.runtime, static_cast<int>(1e3 * to_seconds(settings.window)));
    const auto us = [](Duration d) { return 1e6 * to_seconds(d); };
    return {us(h.quantile(0.5)), us(h.quantile(0.99)), us(h.worst()), h.count()};
}

// Chain, bare chain and ping-pong take turns, a window each.
ChainFigures measure(const ChainSettings& settings, int rounds) {
    ChainFigures figures(settings.runtime.realtime_scheduling ? "SCHED_FIFO" : "default");
    const std::vector<TrialConditions> trials = chain_trials();
    for (int i = 0; i < rounds; ++i) {
        figures.add_chain(run_chain(settings, trials[static_cast<std::size_t>(i) % trials.size()]));
        figures.add_bare(bare_chain_round_trips(settings.runtime, settings.window));
        figures.add_ping_pong(ping_pong(settings));
        if (stop_requested()) throw Error(ExitCode::kRunFailed, "interrupted");
    }
    return figures;
}

int run_chain_study(const ChainOptions& options) {
    install_stop_signals();
    const Scratch scratch;
    ChainSettings settings;
    settings.programs = options.programs.empty() ? own_folder() : fs::path(options.programs);
    settings.scratch = scratch.path();
    settings.base_port = static_cast<std::uint16_t>(options.base_port);
    settings.window = from_seconds(options.window_s);
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const bool realtime : schedulings(options.scheduling)) {
        settings.runtime.realtime_scheduling = realtime;
        const ChainFigures figures = measure(settings, options.rounds);
        if (!options.json) fmt::print("{}\n", figures.table());
        all.push_back(figures.json());
    }
    if (options.json) fmt::print("{}\n", json_text(all, 2));
    return 0;
}

}  // namespace

int chain_study(int argc, char** argv) {
    CLI::App app(
        "Trials of the virtual operator through the five programs, without delay, in windows that alternate "
        "with "
        "bare processes: how much longer a sample takes to its force.",
        "thimble-bench chain");
    ChainOptions options;
    app.add_option("--rounds", options.rounds, "how often everything takes its turn")
        ->check(CLI::Range(2, 1000))
        ->capture_default_str();
    app.add_option("--window-s", options.window_s, "how long a turn takes; a whole trial takes about 15 s")
        ->check(CLI::Range(0.1, 60.0))
        ->capture_default_str();
    app.add_option("--scheduling", options.scheduling, "of all processes")
        ->check(CLI::IsMember({"fifo", "default", "both"}))
        ->capture_default_str();
    app.add_option("--base-port", options.base_port, "first UDP port of the nodes")
        ->check(CLI::Range(1024, 65536 - static_cast<int>(kPortCount)))
        ->capture_default_str();
    app.add_option("--programs", options.programs,
                   "folder of the thimble-* programs, e.g. of another build; by itself that of this one");
    app.add_flag("--json", options.json, "as JSON");
    app.footer("Example:\n  thimble-bench chain --rounds 20");
    if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
    return run_chain_study(options);
}

}  // namespace thimble
