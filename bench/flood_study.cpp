// thimble-bench flood: how a node keeps its deadlines while a stranger without the key floods its ports, beside the same without (docs/security.md). Exit code 1 if a trial ended early, or the loop with real-time scheduling kept its deadlines worse.
#include <algorithm>
#include <array>
#include <atomic>
#include <ctime>
#include <netinet/in.h>
#include <optional>
#include <string>
#include <sys/socket.h>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "bench/network/chain_rounds.hpp"
#include "bench/network/helper_thread.hpp"
#include "bench/network/packet_sniffer.hpp"
#include "bench/network/study_place.hpp"
#include "bench/studies.hpp"
#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/protection.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/udp_channel.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/security/handshake.hpp"
#include "common/security/lab_key_file.hpp"

namespace thimble {
namespace {

using Json = nlohmann::ordered_json;

// Of datagrams without the key: forged forces, handshakes and what is in the clear, at thimble-master, whose loop turns at 1 kHz. They
// name a key that nobody has, and so cost next to nothing. Those with valid headers name the key that is in use, as every header on the
// wire does, and a counter yet to come: each has to be verified, by master, or by slave_sim behind the relay. kNone: nothing.
enum class FloodKind { kNone, kForged, kHandshakes, kUnsealed, kValidHeaders, kValidHeadersAtRelay };
constexpr std::array kFloodNames{"quiet",    "forged",        "handshakes",
                                 "unsealed", "valid_headers", "valid_headers_at_relay"};
constexpr bool has_valid_headers(FloodKind kind) {
    return kind == FloodKind::kValidHeaders || kind == FloodKind::kValidHeadersAtRelay;
}

// With real-time scheduling the share of deadlines that the master misses in a flood may be so many times that without, and one in a
// thousand more: without that, windows that happen to miss none would forbid a single one.
constexpr double kMissedRatio = 3, kMissedAllowance = 0.001;

struct FloodOptions {
    int rounds = 6;
    double window_s = 4;
    double rate_per_s = 1e5;
    int base_port = 27000;
    std::string scheduling = "both";
    bool json = false;
};

// Datagrams in portions, every 200 us as many as are due; a sender that got no processor does not make up for more than 10 ms.
class Flooder {
  public:
    Flooder(FloodKind kind, std::uint16_t base_port, double rate_per_s)
        : kind_(kind), rate_per_s_(rate_per_s), wire_(Endpoint{"127.0.0.1", 0}, target(kind, base_port)) {
        if (has_valid_headers(kind)) ear_.emplace(target(kind, base_port).port, own_port());
    }

    std::uint64_t sent() const { return sent_; }

    void run(const std::atomic<bool>& stop) {
        be_ordinary();
        SessionTime last = wall_now();
        double due = 0;
        while (!stop) {
            const SessionTime now = wall_now();
            due = std::min(due + rate_per_s_ * to_seconds(now - last), rate_per_s_ * 0.01);
            last = now;
            if (ear_) listen();
            for (; due >= 1; --due) say();
            const timespec pause{0, 200'000};
            nanosleep(&pause, nullptr);
        }
    }

  private:
    static Endpoint target(FloodKind kind, std::uint16_t base_port) {
        NetworkSettings network;
        network.base_port = base_port;
        if (kind == FloodKind::kValidHeadersAtRelay) return network.at(Port::kNetemNeedle);
        return network.at(kind == FloodKind::kHandshakes ? Port::kMasterControl : Port::kMasterForce);
    }
    std::uint16_t own_port() const {
        sockaddr_in own{};
        socklen_t size = sizeof own;
        getsockname(wire_.file_descriptor(), reinterpret_cast<sockaddr*>(&own), &size);
        return ntohs(own.sin_port);
    }
    void listen() {
        const auto& datagram = ear_->newest();
        const auto header = read_seal_header(datagram);
        if (!header) return;
        overheard_ = datagram;
        in_use_ = *header;
    }
    void say() {
        if (has_valid_headers(kind_)) return say_valid_headers();
        std::array<std::uint8_t, kHandshakeBytes> bytes{};
        const bool hello = kind_ == FloodKind::kHandshakes;
        const auto kind = hello ? PacketKind::kHello : PacketKind::kData;
        const Port port = hello ? Port::kMasterControl : Port::kMasterForce;
        ++sent_;
        if (kind_ != FloodKind::kUnsealed)
            write_seal_header({kind, port, static_cast<std::uint32_t>(sent_), sent_},
                              std::span(bytes).first<kSealHeaderBytes>());
        wire_.send(bytes);
    }
    void say_valid_headers() {
        if (overheard_.size() < kSealOverheadBytes) return;  // no trial yet
        ++in_use_.counter;
        write_seal_header(in_use_, std::span(overheard_).first<kSealHeaderBytes>());
        ++sent_;
        wire_.send(overheard_);
    }

    FloodKind kind_;
    double rate_per_s_;
    UdpChannel wire_;
    std::uint64_t sent_ = 0;
    std::optional<PacketSniffer> ear_;
    std::vector<std::uint8_t> overheard_;
    SealHeader in_use_;
};

// Of the windows of one kind, together.
struct FloodFigures {
    std::vector<double> lateness_p99_us, round_trip_p99_us;
    double worst_lateness_us = 0, deadlines = 0, missed = 0, refused = 0, sent_per_s = 0;
    int windows = 0, ended_early = 0;

    double missed_share() const { return deadlines > 0 ? missed / deadlines : 0; }
};

double middle_of(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

double refused_by(const Json& report) {
    double refused = 0;
    for (const char* why : {"no_key", "handshake_refused", "unsealed", "forged"})
        refused += report.at("security").at(why).get<double>();
    return refused;
}

void add_report(FloodFigures& figures, const Json& report) {
    const std::string program = report.is_object() ? report.value("program", "") : "";
    if (program == "thimble-master" || program == "thimble-slave-sim") figures.refused += refused_by(report);
    if (program != "thimble-master") return;
    figures.deadlines += report.at("deadlines").get<double>();
    figures.missed += report.at("deadlines_missed").get<double>();
    figures.lateness_p99_us.push_back(report.at("lateness").at("p99_us").get<double>());
    figures.worst_lateness_us =
        std::max(figures.worst_lateness_us, report.at("lateness").at("worst_us").get<double>());
    figures.round_trip_p99_us.push_back(report.at("round_trip").at("p99_us").get<double>());
}

void add_window(FloodFigures& figures, FloodKind kind, const ChainSettings& settings, double rate_per_s) {
    Flooder flooder(kind, settings.base_port, rate_per_s);
    const SessionTime begin = wall_now();
    ChainWindow window;
    {
        std::optional<Helper> helper;
        if (kind != FloodKind::kNone)
            helper.emplace([&flooder](const std::atomic<bool>& stop) { flooder.run(stop); });
        window = run_window(settings, chain_trials().front());
    }
    if (stop_requested()) throw Error(ExitCode::kRunFailed, "interrupted");
    if (kind != FloodKind::kNone)
        figures.sent_per_s += static_cast<double>(flooder.sent()) / to_seconds(wall_now() - begin);
    ++figures.windows;
    const bool in_time = window.reason == EndReason::kTimeout || window.reason == EndReason::kCompleted;
    figures.ended_early += in_time ? 0 : 1;
    for (const Json& report : window.reports) add_report(figures, report);
}

Json describe(const FloodFigures& f, const FloodFigures& quiet) {
    const auto ratio = [](double value, double without) { return without > 0 ? value / without : 0; };
    const double late = middle_of(f.lateness_p99_us), trip = middle_of(f.round_trip_p99_us);
    return {{"windows", f.windows},
            {"ended_early", f.ended_early},
            {"sent_per_s", f.windows > 0 ? f.sent_per_s / f.windows : 0},
            {"refused", f.refused},
            {"deadlines", f.deadlines},
            {"missed_share", f.missed_share()},
            {"lateness_p99_us", late},
            {"lateness_worst_us", f.worst_lateness_us},
            {"round_trip_p99_us", trip},
            {"lateness_p99_ratio", ratio(late, middle_of(quiet.lateness_p99_us))},
            {"round_trip_p99_ratio", ratio(trip, middle_of(quiet.round_trip_p99_us))}};
}

void say_table(const Json& one) {
    fmt::print("{}\n{:<14}{:>10}{:>12}{:>10}{:>12}{:>12}{:>12}{:>8}{:>8}{:>8}\n",
               one.at("scheduling").get<std::string>(), "", "sent/s", "refused", "missed", "late p99 us",
               "worst us", "trip p99 us", "x late", "x trip", "early");
    for (const char* name : kFloodNames) {
        if (!one.contains(name)) continue;
        const Json& f = one.at(name);
        fmt::print("{:<14}{:>10.0f}{:>12.0f}{:>9.3f}%{:>12.1f}{:>12.0f}{:>12.1f}{:>8.2f}{:>8.2f}{:>5}/{}\n",
                   name, f.at("sent_per_s").get<double>(), f.at("refused").get<double>(),
                   100 * f.at("missed_share").get<double>(), f.at("lateness_p99_us").get<double>(),
                   f.at("lateness_worst_us").get<double>(), f.at("round_trip_p99_us").get<double>(),
                   f.at("lateness_p99_ratio").get<double>(), f.at("round_trip_p99_ratio").get<double>(),
                   f.at("ended_early").get<int>(), f.at("windows").get<int>());
    }
    for (const Json& problem : one.at("problems")) fmt::print("  {}\n", problem.get<std::string>());
}

// The broken promises of a flood, in words.
std::vector<std::string> problems_of_floods(const std::array<FloodFigures, kFloodNames.size()>& figures,
                                            bool realtime) {
    std::vector<std::string> problems;
    const double quiet = figures.front().missed_share();
    const double most = kMissedRatio * quiet + kMissedAllowance;
    for (std::size_t kind = 0; kind < figures.size(); ++kind) {
        const FloodFigures& f = figures[kind];
        if (f.ended_early > 0)
            problems.push_back(
                fmt::format("{}: {} of {} trials ended early", kFloodNames[kind], f.ended_early, f.windows));
        if (kind > 0 && f.windows > 0 && f.refused == 0)
            problems.push_back(fmt::format("{}: nothing was refused: there was no flood", kFloodNames[kind]));
        if (realtime && kind > 0 && f.missed_share() > most)
            problems.push_back(fmt::format(
                "{}: {:.3f} % of deadlines missed, {:.3f} % without a flood; at most {:.3f} % may be",
                kFloodNames[kind], 100 * f.missed_share(), 100 * quiet, 100 * most));
    }
    return problems;
}

// Without those with valid headers where loopback cannot be listened to.
std::size_t floods_possible() {
    try {
        const PacketSniffer ear(1, 1);
        return kFloodNames.size();
    } catch (const Error& error) {
        fmt::print(stderr, "left out: {}: {}\n",
                   kFloodNames[static_cast<std::size_t>(FloodKind::kValidHeaders)], error.what());
        return static_cast<std::size_t>(FloodKind::kValidHeaders);
    }
}

Json measure_floods(const ChainSettings& settings, const FloodOptions& options, std::size_t kinds) {
    std::array<FloodFigures, kFloodNames.size()> figures;
    for (int round = 0; round < options.rounds; ++round) {
        for (std::size_t kind = 0; kind < kinds; ++kind)
            add_window(figures[kind], static_cast<FloodKind>(kind), settings, options.rate_per_s);
    }
    Json all{{"scheduling", settings.runtime.realtime_scheduling ? "SCHED_FIFO" : "default"}};
    for (std::size_t kind = 0; kind < kinds; ++kind)
        all[kFloodNames[kind]] = describe(figures[kind], figures.front());
    all["problems"] = problems_of_floods(figures, settings.runtime.realtime_scheduling);
    return all;
}

int run_flood_study(const FloodOptions& options) {
    install_stop_signals();
    const Scratch scratch;
    ChainSettings settings;
    settings.programs = own_folder();
    settings.scratch = scratch.path();
    settings.base_port = static_cast<std::uint16_t>(options.base_port);
    settings.window = from_seconds(options.window_s);
    settings.lab_key = scratch.path() / "lab.key";
    create_lab_key(settings.lab_key, system_random_bytes());
    const std::size_t kinds = floods_possible();
    Json all = Json::array();
    bool good = true;
    for (const bool realtime : schedulings(options.scheduling)) {
        settings.runtime.realtime_scheduling = realtime;
        all.push_back(measure_floods(settings, options, kinds));
        good = good && all.back().at("problems").empty();
        if (!options.json) say_table(all.back());
    }
    if (options.json) fmt::print("{}\n", json_text(all, 2));
    return static_cast<int>(good ? ExitCode::kOk : ExitCode::kRunFailed);
}

}  // namespace

int flood_study(int argc, char** argv) {
    CLI::App app(
        "Trials under a lab key through the five programs, in windows that take turns: nobody else there, "
        "and a flood of datagrams without the key at thimble-master: forged forces, handshakes, what is in "
        "the "
        "clear, and ones with valid headers, under the overheard name of the key in use; those at the relay "
        "as well (they "
        "need "
        "CAP_NET_RAW). 'x': beside quiet. Exit code 1 if a trial ended early, or with SCHED_FIFO more "
        "deadlines "
        "were missed than three times the share without a flood and one in a thousand.",
        "thimble-bench flood");
    FloodOptions options;
    app.add_option("--rounds", options.rounds, "how often everything takes its turn")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    app.add_option("--window-s", options.window_s, "how long a turn takes; a whole trial takes about 15 s")
        ->check(CLI::Range(0.1, 60.0))
        ->capture_default_str();
    app.add_option("--rate", options.rate_per_s, "datagrams per second")
        ->check(CLI::Range(1.0, 1e7))
        ->capture_default_str();
    app.add_option("--scheduling", options.scheduling, "of all nodes")
        ->check(CLI::IsMember({"fifo", "default", "both"}))
        ->capture_default_str();
    app.add_option("--base-port", options.base_port, "first UDP port of the nodes")
        ->check(CLI::Range(1024, 65536 - static_cast<int>(kPortCount)))
        ->capture_default_str();
    app.add_flag("--json", options.json, "as JSON");
    app.footer("Example:\n  thimble-bench flood --rounds 10");
    if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
    return run_flood_study(options);
}

}  // namespace thimble
