#include "thimble/link_test/link_figures.hpp"

#include <algorithm>
#include <array>
#include <cerrno>

#include <fmt/format.h>

namespace thimble {
namespace {

// "Communication administratively prohibited": with network, with host, by filtering (RFC 1812, 5.2.7.1).
constexpr std::array kProhibitedCodes{9, 10, 13};

double missing(std::uint64_t came, std::uint64_t of) {
    if (of == 0) return 0;
    return std::max(0.0, 1 - static_cast<double>(came) / static_cast<double>(of));
}

}  // namespace

const char* to_string(PortAnswer answer) {
    static constexpr std::array kNames{"answers", "nobody listens", "no route", "prohibited", "silent"};
    return kNames[static_cast<std::size_t>(answer)];
}

PortAnswer classify(const PortEvidence& evidence) {
    if (evidence.welcomes > 0) return PortAnswer::kAnswers;
    const bool prohibited = evidence.by_icmp && std::find(kProhibitedCodes.begin(), kProhibitedCodes.end(),
                                                          evidence.icmp_code) != kProhibitedCodes.end();
    if (prohibited && evidence.error != ECONNREFUSED) return PortAnswer::kProhibited;
    switch (evidence.error) {
        case ECONNREFUSED:
            return PortAnswer::kNobodyListens;
        case EACCES:
        case EPERM:
            return PortAnswer::kProhibited;
        case ENETUNREACH:
        case EHOSTUNREACH:
        case ENETDOWN:
        case EHOSTDOWN:
            return PortAnswer::kNoRoute;
        default:
            return PortAnswer::kSilent;
    }
}

std::string diagnose(std::span<const PortAnswer> ports, const std::string& host, unsigned base_port) {
    const auto count = [&](PortAnswer answer) { return std::count(ports.begin(), ports.end(), answer); };
    const auto all = static_cast<std::ptrdiff_t>(ports.size());
    const auto answering = count(PortAnswer::kAnswers);
    if (answering == all) return "";
    if (count(PortAnswer::kNoRoute) == all)
        return fmt::format("no route to {}: check its address, cables, and 'ip route get {}'", host, host);
    if (count(PortAnswer::kProhibited) > 0) {
        return "a firewall rejects the datagrams: a rule of this machine (EPERM) or of a machine on the way "
               "(ICMP); allow UDP on these ports";
    }
    if (count(PortAnswer::kSilent) == all) {
        return fmt::format(
            "{} does not answer at all: it is down, or a firewall drops everything; try 'ping {}'", host,
            host);
    }
    if (count(PortAnswer::kNobodyListens) == all) {
        return fmt::format(
            "{} answers, but nobody listens: start 'thimble link-test --listen --base-port {}' there", host,
            base_port);
    }
    if (count(PortAnswer::kSilent) > 0) {
        return "some ports do not answer and others do: a firewall may block them; allow UDP on all ports of "
               "the session";
    }
    return "nobody listens at some ports: has another program than 'thimble link-test --listen' answered "
           "at the others, or one with another base port?";
}

double PortFigures::loss_there() const { return missing(far_received, sent); }

// Copies that the network made on the way there are echoed too.
double PortFigures::loss_back() const { return missing(std::uint64_t{returned} + duplicates, far_sent); }

bool LinkFigures::all_answer() const {
    return std::all_of(ports.begin(), ports.end(),
                       [](const PortFigures& port) { return port.answer == PortAnswer::kAnswers; });
}

bool LinkFigures::any_answers() const {
    return std::any_of(ports.begin(), ports.end(),
                       [](const PortFigures& port) { return port.answer == PortAnswer::kAnswers; });
}

LoopFigures loop_figures(const LinkFigures& link) {
    LoopFigures loop;
    for (const PortFigures& port : link.ports) {
        if (!port.traffic.haptic || port.sent == 0) continue;
        loop.measured = true;
        loop.round_trip_median_s = std::max(loop.round_trip_median_s, port.round_trip_median_s);
        loop.round_trip_p99_s = std::max(loop.round_trip_p99_s, port.round_trip_p99_s);
        loop.loss = std::max(loop.loss, missing(port.returned, port.sent));
        loop.longest_gap_s = std::max(loop.longest_gap_s, port.longest_gap_s);
    }
    return loop;
}

}  // namespace thimble
