// thimble-bench netem: how near the relay comes to a machine without it, each figure a ratio of two things measured in
// turn in one run (docs/network-relay.md).
#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "bench/network/relay_rounds.hpp"
#include "bench/studies.hpp"
#include "common/runtime/command_line.hpp"
#include "netem/relay/relay_service.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

constexpr Duration kWindow = milliseconds{250};
constexpr Duration kBurst = milliseconds{500};

struct Options {
    int rounds = 8;
    bool default_scheduling = false;
    std::string only;
    std::vector<int> delays_ms{1, 5, 50, 200};
};

struct Row {
    std::string what, goal;
    double ours = 0, bare = 0;  // bare 0: beside nothing
    std::string unit{};
    double stalled = 0;
};

struct Lateness {
    ErrorWindows windows;
    double cpu_s = 0, wall_s = 0;
    std::ptrdiff_t early = 0;
    void add(LatenessRound round) {
        early +=
            std::count_if(round.errors_us.begin(), round.errors_us.end(), [](double e) { return e < 0; });
        windows.add(std::move(round.errors_us));
        cpu_s += round.cpu_s;
        wall_s += round.wall_s;
    }
    double cpu() const { return cpu_s / wall_s; }
};

// Precise, sleeping and bare take turns, a window each.
void measure_lateness(const Options& options, bool granted, Duration delay, std::vector<Row>& rows) {
    Lateness precise, sleeping, bare, spinner;
    for (int i = 0; i < 2 * options.rounds; ++i) {
        bare.add(timer_lateness(kWindow));
        sleeping.add(relay_lateness(Mode::kSleeping, delay, kWindow));
        if (granted) spinner.add(spinner_lateness(kWindow));
        if (granted) precise.add(relay_lateness(Mode::kPrecise, delay, kWindow));
    }
    const WindowErrors b = bare.windows.errors(), s = sleeping.windows.errors(), p = precise.windows.errors();
    const std::string name = fmt::format("{:g} ms", 1e3 * to_seconds(delay));
    const auto row = [&](const char* mode, const WindowErrors& e, const char* goal) {
        rows.push_back({fmt::format("{}, {}, w50", name, mode), "", e.w50_us, b.w50_us, "us", e.stalled});
        rows.push_back({fmt::format("{}, {}, w99", name, mode), goal, e.w99_us, b.w99_us, "us", e.stalled});
    };
    row("sleeping", s, granted ? "<= 1.1" : "<= 1.3");
    if (!granted) return;
    row("precise", p, "<= 0.10");
    row("spinner with a send", spinner.windows.errors(), "");
    rows.push_back({name + ", precise, packets early", "0", static_cast<double>(precise.early)});
    rows.push_back({name + ", sleeping, packets early", "0", static_cast<double>(sleeping.early)});
    rows.push_back(
        {name + ", CPU precise / sleeping", "<= 2", 1e2 * precise.cpu(), 1e2 * sleeping.cpu(), "%"});
}

void measure_throughput(const Options& options, bool granted, std::vector<Row>& rows) {
    std::vector<double> bare, sleeping, precise;
    for (int i = 0; i < options.rounds; ++i) {
        bare.push_back(1e-3 * bare_throughput(kBurst));
        sleeping.push_back(1e-3 * relay_throughput(Mode::kSleeping, milliseconds{50}, kBurst));
        if (granted) precise.push_back(1e-3 * relay_throughput(Mode::kPrecise, milliseconds{50}, kBurst));
    }
    const auto row = [&](const char* mode, const std::vector<double>& found) {
        rows.push_back({fmt::format("packets per second, 50 ms, {}", mode), ">= 0.95", median_of(found),
                        median_of(bare), "k/s"});
    };
    row("sleeping", sleeping);
    if (granted) row("precise", precise);
}

void measure_round_trips(const Options& options, std::vector<Row>& rows) {
    ErrorWindows bare, relay, forwarder;
    for (int i = 0; i < options.rounds; ++i) {
        bare.add(bare_round_trips(250));
        forwarder.add(forwarder_round_trips(250));
        relay.add(relay_round_trips(250));
    }
    const WindowErrors b = bare.errors();
    const auto row = [&](const char* what, const WindowErrors& e, const char* goal) {
        rows.push_back({fmt::format("{}, w50", what), goal, e.w50_us, 2 * b.w50_us, "us", e.stalled});
        rows.push_back({fmt::format("{}, w99", what), "", e.w99_us, 2 * b.w99_us, "us", e.stalled});
    };
    row("round trip, delay 0, one core", relay.errors(), "<= 1.10");
    row("round trip, bare forwarder", forwarder.errors(), "");
}

void print(const std::vector<Row>& rows) {
    fmt::print(
        "| what | relay | bare | ratio | goal | windows with a stall |\n| --- | --- | --- | --- | --- | --- "
        "|\n");
    for (const Row& r : rows) {
        if (r.bare == 0) {
            fmt::print("| {} | {:g} | | | {} | |\n", r.what, r.ours, r.goal);
            continue;
        }
        fmt::print("| {} | {:.4g} {} | {:.4g} {} | {:.3f} | {} | {:.0f} % |\n", r.what, r.ours, r.unit,
                   r.bare, r.unit, r.ours / r.bare, r.goal, 100 * r.stalled);
    }
}

int run(const Options& options) {
    RuntimeSettings runtime;
    runtime.realtime_scheduling = !options.default_scheduling;
    const bool granted = ask_for_precision(runtime, true);
    fmt::print("scheduling: {}\n", granted ? "SCHED_FIFO" : "default");
    std::vector<Row> rows;
    const auto wanted = [&](const char* what) { return options.only.empty() || options.only == what; };
    for (const int delay_ms : options.delays_ms) {
        if (wanted("lateness")) measure_lateness(options, granted, milliseconds{delay_ms}, rows);
    }
    if (wanted("throughput")) measure_throughput(options, granted, rows);
    if (wanted("round-trips")) measure_round_trips(options, rows);
    print(rows);
    return 0;
}

}  // namespace

int network_study(int argc, char** argv) {
    CLI::App app("The relay of thimble-netem beside the bare machine: lateness, CPU, throughput, round trip.",
                 "thimble-bench netem");
    Options options;
    app.add_option("--rounds", options.rounds, "how often everything takes its turn")
        ->check(CLI::Range(2, 1000))
        ->capture_default_str();
    app.add_option("--only", options.only, "of all that: lateness, throughput or round-trips")
        ->check(CLI::IsMember({"lateness", "throughput", "round-trips"}));
    app.add_option("--delay-ms", options.delays_ms, "for which delays lateness is measured")
        ->check(CLI::Range(1, 10000))
        ->capture_default_str();
    app.add_flag("--default-scheduling", options.default_scheduling, "without SCHED_FIFO");
    if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
    return run(options);
}

}  // namespace thimble
