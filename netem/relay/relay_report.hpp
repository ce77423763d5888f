// The settings and results of a relay: as JSON for programs, and as text for people.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "netem/relay/relay_totals.hpp"

namespace thimble {

// Wilson's score interval of a proportion at 95 % (Wilson, JASA 22, 1927): inside [0, 1], sensible at 0 and 1.
struct ProportionInterval {
    double low = 0, high = 1;
};
double share_of(std::uint64_t part, std::uint64_t whole);                     // 0 of nothing
ProportionInterval wilson_95(std::uint64_t successes, std::uint64_t trials);  // {0, 1} for no trials

nlohmann::ordered_json describe(const LinkSettings& link);
// The order of packets under jitter, for people; empty without jitter.
std::string order_text(const LinkSettings& link);
nlohmann::ordered_json describe(const Histogram& error);  // of due times
nlohmann::ordered_json describe(const RelayState& state);
// For the JSON of describe(RelayState), perhaps from another process.
std::string report_text(const nlohmann::ordered_json& report);

// A relay's state in the text format of Prometheus (version 0.0.4).
std::string metrics_text(const RelayState& state);

}  // namespace thimble
