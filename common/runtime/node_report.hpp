// Parts of the report that a program writes at its end (JSON).
#pragma once

#include <cstdint>

#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "common/control/controller_ends.hpp"
#include "common/flow.hpp"
#include "common/runtime/log/message_log.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/sockets.hpp"
#include "common/stale_policy.hpp"
#include "common/stale_record.hpp"

namespace thimble {

// The mode, and counts of protected datagrams.
inline nlohmann::ordered_json describe_security(const Sockets& sockets) {
    const std::string_view mode = to_string(sockets.settings().security.mode);
    if (sockets.security() == nullptr) return {{"mode", mode}};
    const SecurityCounters c = sockets.security()->counters();
    return {{"mode", mode},
            {"sealed", c.sealed},
            {"opened", c.opened},
            {"handshakes", c.handshakes},
            {"forged", c.forged},
            {"replayed", c.replayed},
            {"wrong_role", c.wrong_role},
            {"no_key", c.no_key},
            {"unsealed", c.unsealed},
            {"handshake_refused", c.handshake_refused},
            {"not_sent", c.not_sent}};
}

// A plug-in's calls. Where they took longer than a sample period, the deadlines that were missed are the plug-in's.
inline void describe_plugin(nlohmann::ordered_json& report, const ControllerEnd& end) {
    const ControllerTally tally = end.tally();
    report["plugin"] = {{"file", end.file()},
                        {"samples", tally.samples},
                        {"not_numbers", tally.not_numbers},
                        {"late_samples", tally.late_samples},
                        {"longest_call_s", to_seconds(tally.longest_call)}};
    if (tally.not_numbers > 0)
        spdlog::warn("plug-in {} returned {} values that are not numbers: they counted as 0", end.file(),
                     tally.not_numbers);
    if (tally.late_samples > 0)
        spdlog::warn(
            "plug-in {} missed {} deadlines: its calls took longer than a sample period, one of them {} s",
            end.file(), tally.late_samples, to_seconds(tally.longest_call));
}

// `stale`: the policy in words; `stale_acted`: the trials in which it acted, how often and how long.
inline void describe_stale(nlohmann::ordered_json& report, const StalePolicy& policy,
                           const StaleRecord& record) {
    report["stale"] = policy.text();
    nlohmann::ordered_json trials = nlohmann::ordered_json::array();
    for (const StaleRecord::Trial& one : record.known()) {
        trials.push_back({{"trial", one.trial},
                          {"times", one.times},
                          {"acted_s", to_seconds(one.acted)},
                          {"longest_s", to_seconds(one.longest)}});
    }
    report["stale_acted"] = std::move(trials);
}

// A node's program writes at its end a report (JSON), and puts parts of it into its log.

// `overruns`: runs of missed deadlines as long as [runtime] allows.
nlohmann::ordered_json describe_program(const NodeProgram& program, const NodeInstance& instance,
                                        const Sockets& sockets, const FlowCounters& counters,
                                        const LoopStatistics& loop, std::uint64_t overruns);
// The report's `log`.
nlohmann::ordered_json describe_log(const LogCounters& log);
// In the log, too, which policy for silent inputs acted.
void note_stale(MessageLog& log, const nlohmann::ordered_json& report);

}  // namespace thimble
