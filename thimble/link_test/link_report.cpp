#include "thimble/link_test/link_report.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "analysis/report/run_tables.hpp"
#include "analysis/text/html.hpp"
#include "thimble/link_test/probe_packet.hpp"

namespace thimble {
namespace {

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
        "Round trips in ms, losses in %; jitter: 99 % minus median; out of order and twice: there + back. "
        "Sizes and "
        "rates are those of a session.";
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
        return "Largest datagram: every one that UDP allows passes unfragmented.";
    }
    if (mtu.largest_bytes == 0) return "Largest datagram: not even a session's own passes unfragmented.";
    return fmt::format(
        "Largest datagram that passes unfragmented: {} bytes (MTU {}{}); a session's largest is {}.",
        mtu.largest_bytes, mtu.mtu_bytes(), mtu.limited_here ? ", of this machine's interface" : "",
        largest_session_datagram(report.link));
}

std::string clock_text(const ClockSummary& clock) {
    if (!clock.offset) return "Clocks: not measured.";
    return fmt::format(
        "Clocks: theirs minus ours {:.6f} s +- {:.1f} us, rate {} ppm, {} exchanges, {} steps. One way, us: "
        "there {}, "
        "back {}.",
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

std::size_t largest_session_datagram(const LinkFigures& link) {
    std::size_t largest = 0;
    for (const PortFigures& port : link.ports) largest = std::max(largest, port.traffic.bytes);
    return largest;
}

std::string to_text(const LinkReport& report) {
    std::string text = plain_table(port_table(report.link));
    if (const std::string found = finding(report.link); !found.empty()) text += "\nPorts: " + found + ".\n";
    text += "\n" + mtu_text(report) + "\n" + clock_text(report.link.clock) +
            "\nClock daemon: " + report.chrony + ".\n";
    if (report.link.stalls > 0) {
        text += fmt::format(
            "This machine stood still {} times for more than 50 ms: what it measured is doubtful.\n",
            report.link.stalls);
    }
    text +=
        report.verdicts.empty() ? "\nNo modality is judged: no port of the haptic loop answered.\n" : "\n";
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
    if (!link.all_answer() || link.mtu.largest_bytes < largest_session_datagram(link))
        return ExitCode::kNetwork;
    const bool unfit = std::any_of(report.verdicts.begin(), report.verdicts.end(),
                                   [](const ModalityVerdict& v) { return v.fit == Fit::kDoesNotFit; });
    return unfit ? ExitCode::kRunFailed : ExitCode::kOk;
}

}  // namespace thimble
