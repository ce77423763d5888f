
#include "common/json_text.hpp"
#include "common/runtime/node_report.hpp"
#include "common/version.hpp"

namespace thimble {
namespace {

// The list also has datagrams that the sockets refused before decoding.
nlohmann::ordered_json refusals(FlowCounters counters, const UdpCounters& udp) {
    counters.refused[static_cast<std::size_t>(Refusal::kForeignSource)] += udp.foreign_source;
    counters.refused[static_cast<std::size_t>(Refusal::kTooLong)] += udp.too_long;
    nlohmann::ordered_json names = nlohmann::ordered_json::object();
    for (std::size_t i = 0; i < counters.refused.size(); ++i) {
        names[to_string(static_cast<Refusal>(i))] = counters.refused[i];
    }
    return names;
}

}  // namespace

nlohmann::ordered_json describe_program(const NodeProgram& program, const NodeInstance& instance,
                                        const Sockets& sockets, const FlowCounters& counters,
                                        const LoopStatistics& loop, std::uint64_t overruns) {
    const UdpCounters udp = sockets.counters();
    nlohmann::ordered_json report;
    report["program"] = program.name;
    report["version"] = kVersion;
    report["accepted"] = counters.accepted;
    report["refused"] = refusals(counters, udp);
    report["udp"] = {{"sent", udp.sent},
                     {"received", udp.received},
                     {"send_failed", udp.send_failed},
                     {"foreign_source", udp.foreign_source},
                     {"too_long", udp.too_long}};
    report["security"] = describe_security(sockets);
    report["deadlines"] = loop.deadlines;
    report["deadlines_missed"] = loop.missed;
    report["overruns"] = overruns;
    report["arrivals"] = loop.arrivals;
    report["lateness"] = quantiles(loop.lateness);
    report["turns"] = quantiles(loop.turns);
    instance.describe(report);
    return report;
}

void note_stale(MessageLog& log, const nlohmann::ordered_json& report) {
    for (const auto& one : report.value("stale_acted", nlohmann::ordered_json::array())) {
        log.note("stale", {{"policy", report.value("stale", "")},
                           {"number_on_the_wire", json_text(one.at("trial"))},
                           {"times", json_text(one.at("times"))},
                           {"acted_s", json_text(one.at("acted_s"))},
                           {"longest_s", json_text(one.at("longest_s"))}});
    }
}

nlohmann::ordered_json describe_log(const LogCounters& log) {
    return {{"file", log.file},
            {"messages", log.messages},
            {"bytes", log.bytes},
            {"lost", log.lost},
            {"fault", log.fault}};
}

}  // namespace thimble
