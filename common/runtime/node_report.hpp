// Parts of the report that a program writes at its end (JSON).
#pragma once

#include <nlohmann/json.hpp>

#include "common/security/security.hpp"
#include "common/stale_policy.hpp"
#include "common/stale_record.hpp"

namespace thimble {

// Counts of protected datagrams; null: without protection.
nlohmann::ordered_json describe_security(const Security* security);

// `stale`: the policy in words; `stale_acted`: the trials in which it acted, how often and how long.
void describe_stale(nlohmann::ordered_json& report, const StalePolicy& policy, const StaleRecord& record);

}  // namespace thimble
