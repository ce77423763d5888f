#include "thimble/link_test/link_report.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/report/run_tables.hpp"
#include "analysis/text/html.hpp"
#include "thimble/link_test/probe_packet.hpp"

namespace thimble {
namespace {

constexpr double kLossMarginal = 0.05, kLossTooMuch = 0.5;

struct Finding {
    Fit fit;
    std::string reason;
};

std::string in_ms(double seconds) {
    return std::isinf(seconds) ? "any" : fmt::format("{:.3g} ms", 1000 * seconds);
}

Finding judge_stability(const LoopFigures& link, const LoopLimits& limits) {
    const double hold_s = limits.sample_period_s / 2;
    const double median_s = link.round_trip_median_s + hold_s, p99_s = link.round_trip_p99_s + hold_s;
    const std::string limit = in_ms(limits.critical_delay_s);
    if (p99_s <= limits.critical_delay_s) {
        return {Fit::kFits, fmt::format("loop delay {} (99 %: {}), stable below {}", in_ms(median_s),
                                        in_ms(p99_s), limit)};
    }
    if (median_s <= limits.critical_delay_s) {
        return {Fit::kMarginal,
                fmt::format("loop delay {} is stable, but its 99 % value {} is above the critical {}",
                            in_ms(median_s), in_ms(p99_s), limit)};
    }
    return {Fit::kDoesNotFit, fmt::format("loop delay {} is above the critical {}: contact oscillates",
                                          in_ms(median_s), limit)};
}

Finding judge_depth(Modality modality, const LoopFigures& link, const LoopLimits& limits) {
    const double own_s = limits.latency_s[static_cast<std::size_t>(modality)];
    const double share = link.round_trip_p99_s / own_s;
    const std::string words = fmt::format(
        "{} (99 %) is added to the modality's own {}: the needle goes {:.0f} % further in before it stops",
        in_ms(link.round_trip_p99_s), in_ms(own_s), 100 * share);
    if (share <= 0.5) return {Fit::kFits, words};
    return {share <= 1 ? Fit::kMarginal : Fit::kDoesNotFit, words};
}

Finding judge_pauses(const LoopFigures& link, const LoopLimits& limits) {
    if (link.longest_gap_s > limits.released_s) {
        return {Fit::kDoesNotFit, fmt::format("an interruption of {}: after {} every display goes to zero",
                                              in_ms(link.longest_gap_s), in_ms(limits.released_s))};
    }
    if (link.longest_gap_s > limits.needle_held_s) {
        return {Fit::kMarginal,
                fmt::format("an interruption of {}: after {} the needle is held and contact begins again",
                            in_ms(link.longest_gap_s), in_ms(limits.needle_held_s))};
    }
    return {Fit::kFits, ""};
}

// Only the force at the handle has a known age.
Finding judge_age(const LoopFigures& link, const LoopLimits& limits) {
    if (link.round_trip_p99_s <= limits.late_s) return {Fit::kFits, ""};
    const bool mostly = link.round_trip_median_s > limits.late_s;
    return {mostly ? Fit::kDoesNotFit : Fit::kMarginal,
            fmt::format(
                "{} forces are more than {} late and are ignored, unless [master] oldest_force_s is {:.2g}",
                mostly ? "most" : "some", in_ms(limits.late_s),
                limits.configured_s + 1.2 * link.round_trip_p99_s)};
}

Finding judge_loss(const LoopFigures& link) {
    const std::string words = fmt::format("{:.1f} % of the samples lost", 100 * link.loss);
    if (link.loss >= kLossTooMuch) return {Fit::kDoesNotFit, words};
    return {link.loss > kLossMarginal ? Fit::kMarginal : Fit::kFits, words};
}

using Json = nlohmann::ordered_json;

std::string ms(double seconds) { return fmt::format("{:.3f}", 1000 * seconds); }
std::string percent(double share) { return fmt::format("{:.2f}", 100 * share); }

std::string finding(const LinkFigures& link) {
    std::vector<PortAnswer> answers;
    for (const PortFigures& port : link.ports) answers.push_back(port.answer);
    return diagnose(answers, link.host, link.base_port);
}

ReportTable port_table(const LinkFigures& link) {
    ReportTable table;
    table.title = fmt::format("Ports of {}, from {}", link.host, link.base_port);
    table.note =
        "Round trips in ms, losses in %; jitter: 99 % value minus median; 'out of order' and 'twice' count "
        "both directions. Sizes and rates are those of a session between machines.";
    table.columns = {"port",   "name",  "answer",     "bytes",     "Hz",           "arrived Hz", "median",
                     "jitter", "worst", "lost there", "lost back", "out of order", "twice",      "pause ms"};
    for (const PortFigures& p : link.ports) {
        std::vector<std::string> row{std::to_string(link.base_port + static_cast<unsigned>(p.traffic.port)),
                                     to_string(p.traffic.port), to_string(p.answer),
                                     std::to_string(p.traffic.bytes), fmt::format("{:g}", p.traffic.rate_Hz)};
        if (p.sent > 0) {
            row.insert(row.end(),
                       {fmt::format("{:.0f}", p.rate_there_Hz()), ms(p.round_trip_median_s), ms(p.jitter_s()),
                        ms(p.round_trip_worst_s), percent(p.loss_there()), percent(p.loss_back()),
                        fmt::format("{} + {}", p.far_reordered, p.reordered),
                        fmt::format("{} + {}", p.far_duplicates, p.duplicates),
                        fmt::format("{:.1f}", 1000 * p.longest_gap_s)});
        }
        row.resize(table.columns.size(), std::string(kDash));
        table.rows.push_back(std::move(row));
    }
    return table;
}

std::string mtu_text(const LinkReport& report) {
    const MtuFigures& mtu = report.link.mtu;
    if (!report.link.any_answers()) return "Largest datagram: not measured.";
    if (mtu.largest_bytes == kLargestProbeBytes) {
        return "Largest datagram: UDP's maximum passes unfragmented.";
    }
    if (mtu.largest_bytes == 0)
        return "Largest datagram: not even the datagrams of a session pass unfragmented.";
    return fmt::format(
        "Largest datagram that passes unfragmented: {} bytes (MTU {}{}); a session's have at most {}.",
        mtu.largest_bytes, mtu.mtu_bytes(), mtu.limited_here ? ", of this machine's interface" : "",
        kMaxDatagramBytes);
}

std::string clock_text(const ClockSummary& clock) {
    if (!clock.offset) return "Clocks: not measured.";
    return fmt::format(
        "Clocks: theirs minus ours {:.6f} s +- {:.1f} us, rate {} ppm, {} exchanges, {} steps. One way, us: "
        "there {}, back {}.",
        clock.offset->offset_s(), 1e6 * clock.offset->bound_s(), rate_text_ppm(clock), clock.exchanges,
        clock.steps, one_way_text_us(clock.there), one_way_text_us(clock.back));
}

Json to_json(const PortFigures& p) {
    return {{"name", to_string(p.traffic.port)},
            {"offset", static_cast<unsigned>(p.traffic.port)},
            {"answer", to_string(p.answer)},
            {"bytes", p.traffic.bytes},
            {"rate_Hz", p.traffic.rate_Hz},
            {"haptic", p.traffic.haptic},
            {"sent", p.sent},
            {"refused_here", p.refused},
            {"counted_at_the_end", p.counted},
            {"arrived_there", p.far_received},
            {"arrived_there_Hz", p.rate_there_Hz()},
            {"echoed", p.far_sent},
            {"arrived_back", p.returned},
            {"loss_there", p.loss_there()},
            {"loss_back", p.loss_back()},
            {"duplicates_there", p.far_duplicates},
            {"duplicates_back", p.duplicates},
            {"reordered_there", p.far_reordered},
            {"reordered_back", p.reordered},
            {"round_trip_median_s", p.round_trip_median_s},
            {"round_trip_p99_s", p.round_trip_p99_s},
            {"round_trip_worst_s", p.round_trip_worst_s},
            {"jitter_s", p.jitter_s()},
            {"longest_pause_s", p.longest_gap_s}};
}

// Unknown becomes null, also a one-way delay whose bound is not smaller than itself.
Json one_way(const std::optional<OneWayDelay>& delay) {
    if (!delay) return nullptr;
    return {{"value_s", delay->known() ? Json(delay->median_s) : Json(nullptr)}, {"bound_s", delay->bound_s}};
}

Json to_json(const ClockSummary& clock) {
    Json json{{"exchanges", clock.exchanges}, {"steps", clock.steps}};
    json["offset_s"] = clock.offset ? Json(clock.offset->offset_s()) : Json(nullptr);
    json["bound_s"] = clock.offset ? Json(clock.offset->bound_s()) : Json(nullptr);
    json["rate_low"] = clock.rate_known() ? Json(clock.rate_low) : Json(nullptr);
    json["rate_high"] = clock.rate_known() ? Json(clock.rate_high) : Json(nullptr);
    json["one_way_there"] = one_way(clock.there);
    json["one_way_back"] = one_way(clock.back);
    return json;
}

}  // namespace

const char* to_string(Fit fit) {
    static constexpr std::array kNames{"fits", "marginal", "does not fit"};
    return kNames[static_cast<std::size_t>(fit)];
}

ModalityVerdict judge(Modality modality, const LoopFigures& link, const LoopLimits& limits) {
    const Finding delay =
        modality == Modality::kHF ? judge_stability(link, limits) : judge_depth(modality, link, limits);
    ModalityVerdict verdict{modality, delay.fit, delay.reason};
    const Finding age = modality == Modality::kHF ? judge_age(link, limits) : Finding{Fit::kFits, ""};
    for (const Finding& finding : {age, judge_pauses(link, limits), judge_loss(link)}) {
        if (finding.fit == Fit::kFits) continue;
        verdict.fit = std::max(verdict.fit, finding.fit);
        verdict.reason += "; " + finding.reason;
    }
    return verdict;
}

std::vector<ModalityVerdict> judge_all(const std::vector<Modality>& modalities, const LinkFigures& link,
                                       const LoopLimits& limits) {
    const LoopFigures loop = loop_figures(link);
    std::vector<ModalityVerdict> verdicts;
    if (!loop.measured) return verdicts;
    for (const Modality modality : modalities) verdicts.push_back(judge(modality, loop, limits));
    return verdicts;
}

std::string to_text(const LinkReport& report) {
    std::string text = plain_table(port_table(report.link));
    if (const std::string found = finding(report.link); !found.empty()) text += "\nPorts: " + found + ".\n";
    text += "\n" + mtu_text(report) + "\n" + clock_text(report.link.clock) +
            "\nClock daemon: " + report.chrony + ".\n";
    if (report.link.stalls > 0) {
        text += fmt::format(
            "This machine stood still {} times for more than 50 ms: its measurements are doubtful.\n",
            report.link.stalls);
    }
    text += report.verdicts.empty() ? "\n"
                                      "No verdict on any modality: no port of the haptic loop answered.\n"
                                    : "\n";
    for (const ModalityVerdict& v : report.verdicts)
        text += fmt::format("{:4}{}: {}\n", to_string(v.modality), to_string(v.fit), v.reason);
    return text;
}

Json to_json(const LinkReport& report) {
    const LinkFigures& link = report.link;
    Json json{{"host", link.host}, {"base_port", link.base_port}, {"finding", finding(link)}};
    json["ports"] = Json::array();
    for (const PortFigures& port : link.ports) json["ports"].push_back(to_json(port));
    json["largest_datagram_bytes"] = link.mtu.largest_bytes;
    json["largest_limited_here"] = link.mtu.limited_here;
    json["clock"] = to_json(link.clock);
    json["clock_daemon"] = report.chrony;
    json["stalls_here"] = link.stalls;
    json["modalities"] = Json::array();
    for (const ModalityVerdict& v : report.verdicts) {
        json["modalities"].push_back(
            {{"modality", to_string(v.modality)}, {"verdict", to_string(v.fit)}, {"reason", v.reason}});
    }
    json["exit_code"] = static_cast<int>(exit_code(report));
    return json;
}

ExitCode exit_code(const LinkReport& report) {
    const LinkFigures& link = report.link;
    if (!link.all_answer() || link.mtu.largest_bytes < kMaxDatagramBytes) return ExitCode::kNetwork;
    const bool unfit = std::any_of(report.verdicts.begin(), report.verdicts.end(),
                                   [](const ModalityVerdict& v) { return v.fit == Fit::kDoesNotFit; });
    return unfit ? ExitCode::kRunFailed : ExitCode::kOk;
}

}  // namespace thimble
