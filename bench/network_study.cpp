// thimble-bench netem: how near the relay comes to a machine without it, each figure a ratio of two things measured in
// turn in one run (docs/network-relay.md).
#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/network/flow_fairness.hpp"
#include "bench/network/relay_rounds.hpp"
#include "bench/studies.hpp"
#include "common/json_text.hpp"
#include "common/runtime/command_line.hpp"
#include "netem/relay/relay_service.hpp"

namespace thimble {
namespace {

using Json = nlohmann::ordered_json;
using std::chrono::milliseconds;

constexpr Duration kWindow = milliseconds{250};
constexpr Duration kBurst = milliseconds{500};

struct Options {
    int rounds = 8, flows = 0;
    bool json = false, default_scheduling = false;
    std::string only;
    std::vector<int> delays_ms{1, 5, 50, 200};
};

struct Row {
    std::string what, goal;
    double ours = 0, bare = 0;
    std::string unit;
    double stalled = 0;
    double ratio() const { return bare > 0 ? ours / bare : 0; }
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
    rows.push_back({name + ", precise, packets early", "0", static_cast<double>(precise.early), 0, "", 0});
    rows.push_back({name + ", sleeping, packets early", "0", static_cast<double>(sleeping.early), 0, "", 0});
    rows.push_back(
        {name + ", CPU precise / sleeping", "<= 2", 1e2 * precise.cpu(), 1e2 * sleeping.cpu(), "%", 0});
}

void measure_carried(bool granted, std::vector<Row>& rows) {
    constexpr std::uint64_t kPackets = 1'000'000;
    const CarriedRound r = relay_carries(granted ? Mode::kPrecise : Mode::kSleeping, kPackets);
    const auto row = [&](const char* what, std::uint64_t count, const char* goal) {
        rows.push_back(
            {fmt::format("of {} packets, {}", r.sent, what), goal, static_cast<double>(count), 0, "", 0});
    };
    row("early", r.early, "0");
    row("overtaken", r.overtaken, "0");
    row("not arrived", r.sent - r.arrived, "0");
    row("dropped by full sockets", r.full, "");
}

void measure_throughput(const Options& options, bool granted, std::vector<Row>& rows) {
    std::vector<double> bare, sleeping, precise;
    for (int i = 0; i < options.rounds; ++i) {
        bare.push_back(1e-3 * bare_throughput(kBurst));
        sleeping.push_back(1e-3 * relay_throughput(Mode::kSleeping, milliseconds{50}, kBurst));
        if (granted) precise.push_back(1e-3 * relay_throughput(Mode::kPrecise, milliseconds{50}, kBurst));
    }
    rows.push_back(
        {"packets per second, 50 ms, sleeping", ">= 0.95", median_of(sleeping), median_of(bare), "k/s", 0});
    if (granted)
        rows.push_back(
            {"packets per second, 50 ms, precise", ">= 0.95", median_of(precise), median_of(bare), "k/s", 0});
}

void measure_round_trips(const Options& options, std::vector<Row>& rows) {
    ErrorWindows bare, relay, forwarder;
    for (int i = 0; i < options.rounds; ++i) {
        bare.add(bare_round_trips(250));
        forwarder.add(forwarder_round_trips(250));
        relay.add(relay_round_trips(Mode::kSleeping, 250));
    }
    const WindowErrors b = bare.errors(), r = relay.errors(), f = forwarder.errors();
    rows.push_back(
        {"round trip, delay 0, one core, w50", "<= 1.10", r.w50_us, 2 * b.w50_us, "us", r.stalled});
    rows.push_back({"round trip, delay 0, one core, w99", "", r.w99_us, 2 * b.w99_us, "us", r.stalled});
    rows.push_back({"round trip, bare forwarder, w50", "", f.w50_us, 2 * b.w50_us, "us", f.stalled});
    rows.push_back({"round trip, bare forwarder, w99", "", f.w99_us, 2 * b.w99_us, "us", f.stalled});
}

void print(const std::vector<Row>& rows, bool granted, bool json) {
    Json all = Json::array();
    if (!json) {
        fmt::print(
            "scheduling: {}\n| what | relay | bare | ratio | goal | windows with a stall |\n| --- | --- | "
            "--- | --- | --- | --- |\n",
            granted ? "SCHED_FIFO" : "default");
    }
    for (const Row& r : rows) {
        all.push_back({{"what", r.what},
                       {"relay", r.ours},
                       {"bare", r.bare},
                       {"unit", r.unit},
                       {"ratio", r.ratio()},
                       {"goal", r.goal},
                       {"stalled_windows", r.stalled}});
        if (!json) {
            if (r.bare == 0) {
                fmt::print("| {} | {:g} | | | {} | |\n", r.what, r.ours, r.goal);
                continue;
            }
            fmt::print("| {} | {:.4g} {} | {:.4g} {} | {:.3f} | {} | {:.0f} % |\n", r.what, r.ours, r.unit,
                       r.bare, r.unit, r.ratio(), r.goal, 100 * r.stalled);
        }
    }
    if (json) fmt::print("{}\n", json_text(Json{{"realtime", granted}, {"rows", all}}, 2));
}

// Not beside something bare: the flows are weighed against each other.
int run_fairness(const Options& options) {
    RuntimeSettings runtime;
    runtime.realtime_scheduling = !options.default_scheduling;
    const bool granted = ask_for_precision(runtime, true);
    Json all = Json::array();
    allow_descriptors(2 * static_cast<std::size_t>(options.flows) + 64);
    for (const double greedy_per_s : {0.0, 1e4, 1e5}) {
        const FairnessRound r =
            share_relay(static_cast<std::size_t>(options.flows), greedy_per_s, std::chrono::seconds{5});
        all.push_back({{"flows", options.flows},
                       {"greedy_per_s", greedy_per_s},
                       {"offered_per_s", r.offered_per_s},
                       {"delivered", r.delivered},
                       {"least", r.least},
                       {"most", r.most},
                       {"jain_index", r.index},
                       {"late_median_us", r.late50_us},
                       {"late_99_us", r.late99_us},
                       {"dropped_by_kernel", r.dropped_by_kernel}});
    }
    if (options.json) {
        fmt::print("{}\n", json_text(Json{{"realtime", granted}, {"rows", all}}, 2));
        return 0;
    }
    fmt::print(
        "scheduling: {}\n| flows at 20 Hz | one more at | offered | delivered | least / most of a flow | "
        "Jain's "
        "index | late, 50 / 99 % | dropped by the kernel |\n| --- | --- | --- | --- | --- | --- | --- | --- "
        "|\n",
        granted ? "SCHED_FIFO" : "default");
    for (const Json& r : all) {
        fmt::print(
            "| {} | {:g} /s | {:.0f} /s | {:.2f} % | {:.1f} / {:.1f} % | {:.5f} | {:.0f} / {:.0f} us | "
            "{:.2f} % |\n",
            r["flows"].get<int>(), r["greedy_per_s"].get<double>(), r["offered_per_s"].get<double>(),
            100 * r["delivered"].get<double>(), 100 * r["least"].get<double>(), 100 * r["most"].get<double>(),
            r["jain_index"].get<double>(), r["late_median_us"].get<double>(), r["late_99_us"].get<double>(),
            100 * r["dropped_by_kernel"].get<double>());
    }
    return 0;
}

int run(const Options& options) {
    RuntimeSettings runtime;
    runtime.realtime_scheduling = !options.default_scheduling;
    const bool granted = ask_for_precision(runtime, true);
    std::vector<Row> rows;
    const auto wanted = [&](const char* what) { return options.only.empty() || options.only == what; };
    for (const int delay_ms : options.delays_ms) {
        if (wanted("lateness")) measure_lateness(options, granted, milliseconds{delay_ms}, rows);
    }
    if (wanted("carried")) measure_carried(granted, rows);
    if (wanted("throughput")) measure_throughput(options, granted, rows);
    if (wanted("round-trips")) measure_round_trips(options, rows);
    print(rows, granted, options.json);
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
    app.add_option("--only", options.only, "of all that: lateness, carried, throughput or round-trips")
        ->check(CLI::IsMember({"lateness", "carried", "throughput", "round-trips"}));
    app.add_option("--delay-ms", options.delays_ms, "for which delays lateness is measured")
        ->check(CLI::Range(1, 10000))
        ->capture_default_str();
    app.add_option("--flows", options.flows,
                   "instead: whether that many flows share one relay fairly, alone and beside a greedy one")
        ->check(CLI::Range(1, 10000));
    app.add_flag("--default-scheduling", options.default_scheduling, "without SCHED_FIFO");
    app.add_flag("--json", options.json, "as JSON");
    if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
    return options.flows > 0 ? run_fairness(options) : run(options);
}

}  // namespace thimble
