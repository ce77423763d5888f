// Parts of the report that a program writes at its end (JSON).
#pragma once

#include <nlohmann/json.hpp>

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

}  // namespace thimble
