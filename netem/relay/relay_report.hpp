// The settings and results of a relay: as JSON for programs, and as text for people.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "common/runtime/event_waiter.hpp"
#include "netem/relay/relay_settings.hpp"
#include "netem/relay/relay_totals.hpp"

namespace thimble {

struct RelayState {
    LinkPair links;
    RelayTotals totals;
    WaitCounters waiting;
    Duration margin{};
    bool precise = false;
    Duration send_lead{};  // RelayEngine::send_lead
};

nlohmann::ordered_json describe(const LinkSettings& link);
nlohmann::ordered_json describe(const Histogram& error);  // of due times
nlohmann::ordered_json describe(const RelayState& state);
// For the JSON of describe(RelayState), perhaps from another process.
std::string report_text(const nlohmann::ordered_json& report);

}  // namespace thimble
