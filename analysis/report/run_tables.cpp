#include "analysis/report/run_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "common/json_text.hpp"
#include "session/launch/node_kinds.hpp"
#include "session/records/condition_summary.hpp"

namespace thimble {
namespace {

// master -> netem -> slave_sim -> netem -> master
constexpr double kHops = 4;
constexpr const char* kUnknown = "not known";

std::string microseconds(const nlohmann::ordered_json& lateness, const char* key) {
    return fmt::format("{:.0f}", lateness.value(key, 0.0));
}

std::string program(const NodeReport& node) { return node.report.value("program", std::string("?")); }

}  // namespace

ReportTable deadline_table(const std::vector<NodeReport>& reports) {
    ReportTable table{"Deadlines",
                      "Median, 99 % and worst: lateness of a program's wake-up after its deadline, us. "
                      "Missed: deadlines that were missed by more than 1 ms.",
                      {"condition", "program", "deadlines", "missed", "median", "99 %", "worst"}};
    for (const NodeReport& node : reports) {
        if (!node.report.contains("deadlines")) continue;  // the session's own: it has none
        const auto lateness = node.report.value("lateness", nlohmann::ordered_json::object());
        table.rows.push_back({delay_text(node.delay_s), program(node),
                              std::to_string(node.report.value("deadlines", std::uint64_t{0})),
                              std::to_string(node.report.value("deadlines_missed", std::uint64_t{0})),
                              microseconds(lateness, "median_us"), microseconds(lateness, "p99_us"),
                              microseconds(lateness, "worst_us")});
    }
    return table;
}

ReportTable refusal_table(const std::vector<NodeReport>& reports) {
    ReportTable table{
        "Refused datagrams",
        "Refused datagrams do no harm: the program counts them by reason and drops them. Counts of zero are "
        "left out. wrong_trial: datagrams that were still on their way when a trial ended.",
        {"condition", "program", "reason", "count"}};
    for (const NodeReport& node : reports) {
        const auto refused = node.report.value("refused", nlohmann::ordered_json::object());
        for (const auto& [reason, count] : refused.items()) {
            if (count.get<std::uint64_t>() == 0) continue;
            table.rows.push_back({delay_text(node.delay_s), program(node), reason, json_text(count)});
        }
    }
    return table;
}

ReportTable security_table(const std::vector<NodeReport>& reports) {
    constexpr std::array kRefusals{"forged", "replayed", "wrong_role",
                                   "no_key", "unsealed", "handshake_refused"};
    ReportTable table{"Protection",
                      "Datagrams that each program encrypted (sealed) and decrypted (opened). Handshakes "
                      "that it completed: one, and one more for each renewal or restart. Last columns: "
                      "refused datagrams by reason. The program thimble runs the session.",
                      {"condition", "program", "sealed", "opened", "handshakes"}};
    table.columns.insert(table.columns.end(), kRefusals.begin(), kRefusals.end());
    for (const NodeReport& node : reports) {
        const auto security = node.report.value("security", nlohmann::ordered_json::object());
        if (security.value("mode", "none") == "none") continue;
        std::vector<std::string> row{delay_text(node.delay_s), program(node)};
        for (const char* name : {"sealed", "opened", "handshakes"})
            row.push_back(std::to_string(security.value(name, std::uint64_t{0})));
        for (const char* name : kRefusals)
            row.push_back(std::to_string(security.value(name, std::uint64_t{0})));
        table.rows.push_back(std::move(row));
    }
    return table;
}

ReportTable stale_table(const std::vector<NodeReport>& reports) {
    ReportTable table{"Silent inputs",
                      "Inputs that received nothing for longer than their time-out: the policy that acted, "
                      "how often, and for how long.",
                      {"condition", "program", "policy", "trial", "times", "acted, ms", "longest, ms"}};
    for (const NodeReport& node : reports) {
        const auto acted = node.report.value("stale_acted", nlohmann::ordered_json::array());
        for (const auto& one : acted) {
            table.rows.push_back({delay_text(node.delay_s), program(node), node.report.value("stale", ""),
                                  json_text(one.at("trial")), json_text(one.at("times")),
                                  fmt::format("{:.1f}", 1e3 * one.value("acted_s", 0.0)),
                                  fmt::format("{:.1f}", 1e3 * one.value("longest_s", 0.0))});
        }
    }
    return table;
}

ReportTable machine_table(const NodeStarter& starter, const NetworkSettings& network) {
    ReportTable table{"Machines",
                      "Machine of each node. The bare round trip above was measured on this machine, without "
                      "a network cable, so its ratio includes the cables.",
                      {"program", "machine", "address"}};
    const auto add = [&](const char* program, const std::string& machine, Role role) {
        table.rows.push_back({program, machine.empty() ? "this one" : machine, network.host(role)});
    };
    add("thimble", "", Role::kSession);
    for (const NodeKind& node : kNodes) add(node.program, starter.machine(node.role), node.role);
    return table;
}

ReportTable round_trip_table(const std::vector<TrialRow>& rows, const Histogram& bare) {
    ReportTable table{
        "Round trip",
        fmt::format("Time from an encoder sample to its force at the handle: {} hops through netem and "
                    "slave_sim, with the codec. Bare: two blocking processes in the same run, {} exchanges "
                    "with a median of {:.1f} us for both ways (99 %: {:.0f} us), times {}.",
                    kHops, bare.count(), to_seconds(bare.quantile(0.5)) * 1e6,
                    to_seconds(bare.quantile(0.99)) * 1e6, kHops / 2),
        {"condition", "modality", "median, us", "bare x hops, us", "ratio"}};
    const double bare_us = to_seconds(bare.quantile(0.5)) * 1e6 * kHops / 2;
    for (const TrialRow& row : rows) {
        if (row.conditions.delay_s > 0 || std::isnan(row.round_trip_s)) continue;
        const double loop_us = row.round_trip_s * 1e6;
        table.rows.push_back({delay_text(row.conditions.delay_s), to_string(row.conditions.modality),
                              fmt::format("{:.0f}", loop_us), fmt::format("{:.0f}", bare_us),
                              fmt::format("{:.2f}", loop_us / bare_us)});
    }
    return table;
}

std::string one_way_text_us(const std::optional<OneWayDelay>& delay) {
    if (!delay) return kUnknown;
    const double bound_us = 1e6 * delay->bound_s;
    if (!delay->known()) return fmt::format("not known: +-{:.1f}", bound_us);
    return fmt::format("{:.1f} +-{:.1f}", 1e6 * delay->median_s, bound_us);
}

std::string rate_text_ppm(const ClockSummary& clock) {
    if (!clock.even) return "not constant";
    if (!clock.rate_known()) return kUnknown;
    return fmt::format("{:.2f} to {:.2f}", 1e6 * clock.rate_low, 1e6 * clock.rate_high);
}

ReportTable clock_table(const std::vector<NodeClock>& clocks) {
    ReportTable table{
        "Clocks",
        "Offset: clock of the node minus clock of the session, at the last exchange. The true value lies "
        "within offset +- bound, for any behaviour of the network. Rate: gain of the node's clock; the whole "
        "range that the exchanges allow. The exchanges use the control channel, not the emulated network. "
        "There, back: one-way delays of the control channel, shown if the bound is smaller than the value. "
        "For two nodes, subtract the offsets and add the bounds.",
        {"condition", "node", "offset, s", "bound, us", "rate, ppm", "exchanges", "steps", "there, us",
         "back, us"}};
    for (const NodeClock& clock : clocks) {
        const ClockSummary& s = clock.summary;
        table.rows.push_back({delay_text(clock.delay_s), to_string(clock.node),
                              s.offset ? fmt::format("{:.6f}", s.offset->offset_s()) : kUnknown,
                              s.offset ? fmt::format("{:.1f}", 1e6 * s.offset->bound_s()) : kUnknown,
                              rate_text_ppm(s), std::to_string(s.exchanges), std::to_string(s.steps),
                              one_way_text_us(s.there), one_way_text_us(s.back)});
    }
    return table;
}

}  // namespace thimble
