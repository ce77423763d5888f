// Whether this machine can be trusted with a profile: own traffic through an own relay over loopback, compared with what
// was asked, beside this machine's bare timer. Findings are data; the verdict is arithmetic on them (verdict()).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/histogram.hpp"
#include "common/runtime/runtime_settings.hpp"
#include "netem/relay/relay_report.hpp"
#include "netem/relay/relay_settings.hpp"
#include "netem/relay/selftest_twin.hpp"

namespace thimble {

struct SelftestSettings {
    LinkPair links;
    TimelinePair timelines;
    std::uint64_t seed = 1;
    Duration length = std::chrono::seconds{10};  // at least one; a fifth of it goes to the bare timer
    bool precise = false;
    RuntimeSettings runtime;
};

struct SelftestDirection {
    std::uint64_t offered = 0;      // sent by the traffic
    std::uint64_t received = 0;     // by the relay
    std::uint64_t arrived = 0;      // first copies, unharmed, at the other end
    std::uint64_t dropped = 0;      // by the link, as asked
    std::uint64_t lost = 0;         // of these by its loss model, or a trace
    std::uint64_t early = 0;        // sent before they were due
    std::uint64_t other_fates = 0;  // dropped where virtual time with this seed does not, or the reverse
    // Neither asked nor explained: lost on the way to the relay, in it, or behind it.
    std::uint64_t lost_by_machine = 0;
    double lost_mean = 0;    // over all seeds
    double lost_chance = 1;  // share of seeds that lose a number as far out (LossLaw::chance_of)
    Comparison comparison;
    std::vector<double> delays_s;  // achieved, from send to the kernel's stamp at the other end, sorted
};

enum class SelftestVerdict { kPass, kMarginal, kFail };
std::string_view to_string(SelftestVerdict verdict);

struct SelftestResult {
    RelayState state;
    std::array<SelftestDirection, 2> direction;  // RelayDirection
    Histogram timer;                             // bare, before and after the traffic
    SelftestVerdict verdict = SelftestVerdict::kPass;
    std::vector<std::string> causes;  // of a verdict that is not PASS
};

// Sets verdict and causes from the rest.
void judge(SelftestResult& result);

// Throws Error (network) if loopback UDP cannot be used.
SelftestResult run_selftest(const SelftestSettings& settings);

nlohmann::ordered_json describe(const SelftestResult& result);
std::string selftest_text(const SelftestResult& result);

}  // namespace thimble
