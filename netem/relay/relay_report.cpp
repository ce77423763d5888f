#include "netem/relay/relay_report.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "common/version.hpp"

namespace thimble {
namespace {

using Json = nlohmann::ordered_json;

double us(Duration duration) { return static_cast<double>(duration.count()) * 1e-3; }

Json describe_packets(const DirectionTotals& totals) {
    const LinkCounters& c = totals.packets;
    return {{"received", c.pushed},
            {"sent", c.delivered - totals.refused},
            {"lost", c.lost},
            {"outage", c.outage},
            {"queue_full", c.queue_full},
            {"overflowed", c.overflowed},
            {"empty_or_too_long", c.oversized},
            {"refused_by_kernel", totals.refused},
            {"duplicated", c.duplicated},
            {"corrupted", c.corrupted},
            {"reordered", c.reordered},
            {"marked", c.marked},
            {"in_flight", totals.in_flight},
            {"bytes_sent", totals.bytes}};
}

Json describe_delay(const LinkSettings& link, const DirectionTotals& totals) {
    const Histogram& delay = totals.delay;
    return {{"asked_mean_s", to_seconds(mean_delay(link))},
            {"achieved_mean_s", totals.delay_moments.mean_s()},
            {"achieved_sd_s", totals.delay_moments.deviation_s()},
            {"achieved_least_s", to_seconds(delay.best())},
            {"achieved_median_s", to_seconds(delay.quantile(0.5))},
            {"achieved_p99_s", to_seconds(delay.quantile(0.99))},
            {"achieved_worst_s", to_seconds(delay.worst())}};
}

// Of all packets: the loss model decides first, also on those in an outage.
Json describe_loss(const LinkSettings& link, const LinkCounters& packets) {
    const ProportionInterval interval = wilson_95(packets.lost, packets.pushed);
    return {{"asked", mean_loss(link)},
            {"achieved", share_of(packets.lost, packets.pushed)},
            {"low_95", interval.low},
            {"high_95", interval.high}};
}

Json describe_direction(const LinkSettings& link, const DirectionTotals& totals) {
    return {{"asked", describe(link)},
            {"packets", describe_packets(totals)},
            {"delay", describe_delay(link, totals)},
            {"loss", describe_loss(link, totals.packets)},
            {"due_time_error", describe(totals.error)},
            {"later_than_1ms", totals.late}};
}

std::string direction_text(const std::string& title, const Json& d) {
    const Json &p = d.at("packets"), &delay = d.at("delay"), &loss = d.at("loss"),
               &e = d.at("due_time_error");
    std::string text =
        fmt::format("{:<5} {} received, {} sent, {} lost", title, p.at("received").get<std::uint64_t>(),
                    p.at("sent").get<std::uint64_t>(), p.at("lost").get<std::uint64_t>());
    for (const char* fate : {"outage", "queue_full", "overflowed", "empty_or_too_long", "refused_by_kernel",
                             "duplicated", "corrupted", "reordered", "marked"}) {
        if (const auto count = p.at(fate).get<std::uint64_t>(); count > 0)
            text += fmt::format(", {} {}", count, fate);
    }
    text += fmt::format(
        "\n      delay    asked {:.6g} ms, achieved {:.6g} mean, {:.4g} standard deviation, {:.6g} median, "
        "{:.6g} p99, {:.6g} worst\n",
        1e3 * delay.at("asked_mean_s").get<double>(), 1e3 * delay.at("achieved_mean_s").get<double>(),
        1e3 * delay.at("achieved_sd_s").get<double>(), 1e3 * delay.at("achieved_median_s").get<double>(),
        1e3 * delay.at("achieved_p99_s").get<double>(), 1e3 * delay.at("achieved_worst_s").get<double>());
    text += fmt::format("      loss     asked {:.4g} %, achieved {:.4g} % [{:.4g}, {:.4g}]\n",
                        100 * loss.at("asked").get<double>(), 100 * loss.at("achieved").get<double>(),
                        100 * loss.at("low_95").get<double>(), 100 * loss.at("high_95").get<double>());
    text += fmt::format("      late by  {:.4g} us median, {:.4g} p99, {:.4g} p99.9, {:.4g} worst\n",
                        e.at("median_us").get<double>(), e.at("p99_us").get<double>(),
                        e.at("p999_us").get<double>(), e.at("worst_us").get<double>());
    return text;
}

std::string machine_text(const Json& report) {
    const Json& m = report.at("machine");
    std::string text = fmt::format("      {} stalls above 1 ms", m.at("stalls").get<std::uint64_t>());
    for (const char* key : {"dropped_by_kernel", "clock_steps", "untrusted_stamps", "spinning_gave_up"}) {
        if (const auto count = m.at(key).get<std::uint64_t>(); count > 0)
            text += fmt::format(", {} {}", count, key);
    }
    if (const auto missing = report.at("log_missing").get<std::uint64_t>(); missing > 0) {
        text += fmt::format(", {} packets missing in the log", missing);
    }
    if (const auto closed = report.at("closed_port_answers").get<std::uint64_t>(); closed > 0) {
        text += fmt::format(", {} answers that the port behind --to is closed", closed);
    }
    return text + "\n";
}

}  // namespace

double share_of(std::uint64_t part, std::uint64_t whole) {
    return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

ProportionInterval wilson_95(std::uint64_t successes, std::uint64_t trials) {
    if (trials == 0) return {};
    constexpr double kZ = 1.959963984540054;  // normal quantile of 0.975
    const auto n = static_cast<double>(trials);
    const double p = static_cast<double>(successes) / n;
    const double shrink = 1 + kZ * kZ / n;
    const double centre = (p + kZ * kZ / (2 * n)) / shrink;
    const double half = kZ / shrink * std::sqrt(p * (1 - p) / n + kZ * kZ / (4 * n * n));
    return {successes == 0 ? 0.0 : std::max(0.0, centre - half),
            successes == trials ? 1.0 : std::min(1.0, centre + half)};
}

nlohmann::ordered_json describe(const LinkSettings& link) {
    return {{"delay_s", to_seconds(mean_delay(link))},
            {"jitter", to_string(link.jitter.shape)},
            {"jitter_spread_s", to_seconds(link.jitter.spread)},
            {"jitter_correlation", link.jitter.correlation},
            {"loss", mean_loss(link)},
            {"duplicate", link.duplicate},
            {"corrupt", link.corrupt},
            {"reorder", link.reorder},
            {"in_order", link.in_order},
            {"rate_bit_per_s", link.rate.bits_per_s},
            {"outages", link.outages.size()},
            {"trace", link.trace != nullptr},
            {"delivery_trace", link.deliveries != nullptr},
            {"capacity", link.capacity}};
}

std::string order_text(const LinkSettings& link) {
    if (link.jitter.shape == JitterShape::kNone) return "";
    if (!link.in_order) return "packets overtake each other under jitter (in_order = true keeps their order)";
    return fmt::format(
        "order is kept: a packet waits for the one before it, so the mean delay can be far above {:g} ms "
        "(in_order = false lets packets overtake)",
        1e3 * to_seconds(mean_delay(link)));
}

nlohmann::ordered_json describe(const Histogram& error) {
    return {{"median_us", us(error.quantile(0.5))},
            {"p99_us", us(error.quantile(0.99))},
            {"p999_us", us(error.quantile(0.999))},
            {"worst_us", us(error.worst())},
            {"count", error.count()}};
}

nlohmann::ordered_json describe(const RelayState& state) {
    const RelayTotals& t = state.totals;
    Json json{{"version", kVersion},
              {"running_s", to_seconds(t.running)},
              {"flows",
               {{"open", t.flows},
                {"opened", t.flows_opened},
                {"packets_refused", t.flows_refused},
                {"packets_failed", t.flows_failed}}},
              {"up", describe_direction(state.links.up, t[RelayDirection::kUp])},
              {"down", describe_direction(state.links.down, t[RelayDirection::kDown])}};
    json["machine"] = {{"waiting", state.precise ? "precise" : "sleeping"},
                       {"margin_us", us(state.margin)},
                       {"send_lead_us", us(state.send_lead)},
                       {"spun_s", to_seconds(state.waiting.spun)},
                       {"spinning_gave_up", state.waiting.exhausted},
                       {"stalls", t.stalls},
                       {"dropped_by_kernel", t.dropped_by_kernel},
                       {"clock_steps", t.clock_steps},
                       {"untrusted_stamps", t.untrusted_stamps}};
    json["log_missing"] = t.log_missing;
    json["closed_port_answers"] =
        std::accumulate(t.closed_ports.begin(), t.closed_ports.end(), std::uint64_t{0});
    return json;
}

std::string report_text(const nlohmann::ordered_json& report) {
    const Json& flows = report.at("flows");
    std::string text =
        fmt::format("{:.1f} s, {} flows ({} open), {} waiting\n", report.at("running_s").get<double>(),
                    flows.at("opened").get<std::uint64_t>(), flows.at("open").get<std::uint64_t>(),
                    report.at("machine").at("waiting").get<std::string>());
    if (const auto refused = flows.at("packets_refused").get<std::uint64_t>(); refused > 0) {
        text +=
            fmt::format("{} packets of clients beyond the limit were dropped: raise --max-flows\n", refused);
    }
    if (const auto failed = flows.at("packets_failed").get<std::uint64_t>(); failed > 0)
        text += fmt::format("{} packets of clients were dropped: see the warning about the server\n", failed);
    return text + direction_text("up", report.at("up")) + direction_text("down", report.at("down")) +
           machine_text(report);
}

}  // namespace thimble
