// The meaning of a self-test's findings, and their words.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "netem/relay/selftest.hpp"

namespace thimble {
namespace {

using Json = nlohmann::ordered_json;

// A session samples at 1 kHz: what is a whole sample late belongs to the next.
constexpr double kSample_us = 1000;
constexpr double kUneasy_us = 200;     // a fifth of it
constexpr double kTimerSlack_us = 20;  // by which the relay may exceed the bare timer and half as much again
constexpr double kManyLost = 1e-3;     // of the packets, by the machine
constexpr std::uint64_t kFewPackets = 2000;
// Of all seeds so few may be called MARGINAL and FAIL for the number of their losses, in each direction.
constexpr double kRareSeed = 1e-4;
constexpr double kImpossibleSeed = 1e-6;

double in_us(Duration duration) { return static_cast<double>(duration.count()) * 1e-3; }

void judge_direction(SelftestResult& result, std::string_view name, const SelftestDirection& d,
                     const Histogram& error) {
    const auto say = [&](SelftestVerdict verdict, std::string_view cause) {
        result.verdict = std::max(result.verdict, verdict);
        result.causes.push_back(fmt::format("{}: {}", name, cause));
    };
    // Whichever of the two limits `value` exceeds.
    const auto limit = [&](double value, double marginal, double fail, std::string_view cause) {
        if (value > marginal) say(value > fail ? SelftestVerdict::kFail : SelftestVerdict::kMarginal, cause);
    };
    const double p99_us = in_us(error.quantile(0.99)), p999_us = in_us(error.quantile(0.999));
    const double timer_us = in_us(result.timer.quantile(0.99));
    limit(static_cast<double>(d.early), 0, 0, fmt::format("{} packets left before they were due", d.early));
    limit(static_cast<double>(d.other_fates), 0, 0,
          fmt::format("{} packets did not have the fate of their seed", d.other_fates));
    limit(static_cast<double>(d.lost_by_machine), 0, kManyLost * static_cast<double>(d.offered),
          fmt::format("the machine lost {} of {} packets that the profile delivers", d.lost_by_machine,
                      d.offered));
    limit(p99_us, kUneasy_us, kSample_us,
          fmt::format("1 % of the packets leave more than {:.0f} us late (the bare timer: {:.0f} us)", p99_us,
                      timer_us));
    limit(
        p999_us, kSample_us, HUGE_VAL,
        fmt::format("1 in 1000 packets leaves more than {:.1f} ms late: the machine stalls", 1e-3 * p999_us));
    limit(p99_us, 1.5 * timer_us + kTimerSlack_us, HUGE_VAL,
          fmt::format("more late than the bare timer (99 %: {:.0f} us against {:.0f} us)", p99_us, timer_us));
    if (d.comparison.spread) {
        limit(d.comparison.distance_ratio(), 1.5, 3,
              fmt::format(
                  "the delays do not follow the requested distribution: KS distance {:.4f}, by chance {:.4f}",
                  d.comparison.distance, d.comparison.by_chance));
    }
    limit(-d.lost_chance, -kRareSeed, -kImpossibleSeed,
          fmt::format("{} packets lost instead of {:.4g}; only {:.2g} of all seeds differ so much", d.lost,
                      d.lost_mean, d.lost_chance));
    if (d.received < kFewPackets) {
        say(SelftestVerdict::kMarginal,
            fmt::format("only {} packets, too few for rare delays: test longer", d.received));
    }
}

double quantile_s(const std::vector<double>& sorted, double q) {
    return sorted.empty() ? 0 : sorted[static_cast<std::size_t>(q * static_cast<double>(sorted.size() - 1))];
}

Json describe_findings(const SelftestDirection& d, const Histogram& error) {
    const ProportionInterval interval = wilson_95(d.dropped, d.received);
    const double expected = d.received == 0 ? 0 : d.comparison.dropped_mean / static_cast<double>(d.received);
    Json json{{"offered", d.offered},          {"received", d.received},
              {"dropped_as_asked", d.dropped}, {"lost_as_asked", d.lost},
              {"arrived", d.arrived},          {"early", d.early},
              {"other_fates", d.other_fates},  {"lost_by_machine", d.lost_by_machine}};
    json["loss"] = {{"expected", expected},     {"achieved", share_of(d.dropped, d.received)},
                    {"low_95", interval.low},   {"high_95", interval.high},
                    {"lost_mean", d.lost_mean}, {"lost_chance", d.lost_chance}};
    json["delay"] = {{"median_s", quantile_s(d.delays_s, 0.5)},
                     {"p99_s", quantile_s(d.delays_s, 0.99)},
                     {"distribution_tested", d.comparison.spread},
                     {"ks_distance", d.comparison.distance},
                     {"ks_by_chance", d.comparison.by_chance}};
    json["due_time_error"] = describe(error);
    return json;
}

std::string lateness_text(const Histogram& e) {
    return fmt::format("{:.4g} us median, {:.4g} p99, {:.4g} p99.9, {:.4g} worst", in_us(e.quantile(0.5)),
                       in_us(e.quantile(0.99)), in_us(e.quantile(0.999)), in_us(e.worst()));
}

std::string findings_text(std::string_view name, const LinkSettings& link, const SelftestDirection& d,
                          const Histogram& error) {
    const ProportionInterval loss = wilson_95(d.dropped, d.received);
    return fmt::format(
        "{:<5} {} packets, {} dropped as requested ({:.3g} % [{:.3g}, {:.3g}]), {} by the machine\n"
        "      delay    asked {:.6g} ms, achieved {:.6g} median, {:.6g} p99; {}\n"
        "      late by  {}\n",
        name, d.offered, d.dropped, 100 * share_of(d.dropped, d.received), 100 * loss.low, 100 * loss.high,
        d.lost_by_machine, 1e3 * to_seconds(mean_delay(link)), 1e3 * quantile_s(d.delays_s, 0.5),
        1e3 * quantile_s(d.delays_s, 0.99),
        d.comparison.spread
            ? fmt::format("KS {:.4f}, by chance {:.4f}", d.comparison.distance, d.comparison.by_chance)
            : "constant",
        lateness_text(error));
}

}  // namespace

std::string_view to_string(SelftestVerdict verdict) {
    constexpr std::array<std::string_view, 3> kNames{"PASS", "MARGINAL", "FAIL"};
    return kNames[static_cast<std::size_t>(verdict)];
}

void judge(SelftestResult& result) {
    result.verdict = SelftestVerdict::kPass;
    result.causes.clear();
    for (const RelayDirection d : {RelayDirection::kUp, RelayDirection::kDown}) {
        judge_direction(result, to_string(d), result.direction[static_cast<std::size_t>(d)],
                        result.state.totals[d].error);
    }
}

nlohmann::ordered_json describe(const SelftestResult& result) {
    Json json{{"verdict", to_string(result.verdict)}, {"causes", result.causes}};
    for (const RelayDirection d : {RelayDirection::kUp, RelayDirection::kDown}) {
        json[std::string(to_string(d))] =
            describe_findings(result.direction[static_cast<std::size_t>(d)], result.state.totals[d].error);
    }
    json["bare_timer"] = describe(result.timer);
    json["relay"] = describe(result.state);
    return json;
}

std::string selftest_text(const SelftestResult& result) {
    const RelayTotals& totals = result.state.totals;
    return findings_text("up", result.state.links.up, result.direction[0], totals.direction[0].error) +
           findings_text("down", result.state.links.down, result.direction[1], totals.direction[1].error) +
           fmt::format("bare timer late by {}; {} stalls\n{}\n", lateness_text(result.timer), totals.stalls,
                       to_string(result.verdict)) +
           (result.causes.empty() ? "" : fmt::format("  {}\n", fmt::join(result.causes, "\n  ")));
}

}  // namespace thimble
