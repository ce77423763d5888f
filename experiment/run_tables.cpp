#include "experiment/run_tables.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "experiment/condition_summary.hpp"
#include "experiment/launch/node_kinds.hpp"

namespace thimble {
namespace {

// master -> netem -> slave_sim -> netem -> master
constexpr double kHops = 4;

std::string microseconds(const nlohmann::ordered_json& lateness, const char* key) {
    return fmt::format("{:.0f}", lateness.value(key, 0.0));
}

std::string program(const NodeReport& node) { return node.report.value("program", std::string("?")); }

}  // namespace

ReportTable deadline_table(const std::vector<NodeReport>& reports) {
    ReportTable table;
    table.title = "Deadlines";
    table.note = "Lateness: wake-up after its absolute deadline, in microseconds. Missed: by more than 1 ms.";
    table.columns = {"condition", "program", "deadlines", "missed", "median", "99 %", "worst"};
    for (const NodeReport& node : reports) {
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
    ReportTable table;
    table.title = "Refused datagrams";
    table.note =
        "Each is counted by its reason and otherwise harmless; counters at zero are left out. wrong_trial "
        "counts "
        "what was still on its way when a trial ended.";
    table.columns = {"condition", "program", "reason", "count"};
    for (const NodeReport& node : reports) {
        const auto refused = node.report.value("refused", nlohmann::ordered_json::object());
        for (const auto& [reason, count] : refused.items()) {
            if (count.get<std::uint64_t>() == 0) continue;
            table.rows.push_back({delay_text(node.delay_s), program(node), reason, count.dump()});
        }
    }
    return table;
}

bool runs_elsewhere(const NodeStarter& starter) {
    return std::any_of(kNodes.begin(), kNodes.end(),
                       [&](const NodeKind& node) { return !starter.machine(node.role).empty(); });
}

ReportTable machine_table(const NodeStarter& starter, const NetworkSettings& network) {
    ReportTable table;
    table.title = "Machines";
    table.note =
        "Where each node ran. The bare round trip above is this machine's own, without a wire: a ratio to it "
        "holds the wires as well.";
    table.columns = {"program", "machine", "address"};
    const auto add = [&](const char* program, const std::string& machine, Role role) {
        table.rows.push_back({program, machine.empty() ? "this one" : machine, network.host(role)});
    };
    add("thimble", "", Role::kSession);
    for (const NodeKind& node : kNodes) add(node.program, starter.machine(node.role), node.role);
    return table;
}

ReportTable round_trip_table(const std::vector<TrialRow>& rows, const Histogram& bare) {
    ReportTable table;
    table.title = "Round trip";
    table.note = fmt::format(
        "Encoder sample to its force at the handle: {} hops through netem and slave_sim, codec and all. "
        "Bare: two "
        "processes, blocking, {} exchanges in the same run, median {:.1f} us there and back (99 % {:.0f} "
        "us), times {}.",
        kHops, bare.count(), to_seconds(bare.quantile(0.5)) * 1e6, to_seconds(bare.quantile(0.99)) * 1e6,
        kHops / 2);
    table.columns = {"condition", "modality", "median, us", "bare x hops, us", "ratio"};
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

}  // namespace thimble
