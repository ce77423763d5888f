#include "thimble/link_test/port_finding.hpp"

#include <algorithm>
#include <array>
#include <cerrno>

#include <fmt/format.h>

namespace thimble {
namespace {

// "Communication administratively prohibited": with network, with host, by filtering (RFC 1812, 5.2.7.1).
constexpr std::array kProhibitedCodes{9, 10, 13};

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
        return "a firewall says no: the datagrams are prohibited by this machine's own rules (EPERM) or by "
               "one on "
               "the way (ICMP); allow UDP on these ports";
    }
    if (count(PortAnswer::kSilent) == all) {
        return fmt::format(
            "{} says nothing at all: it is down, or a firewall drops everything; see 'ping {}'", host, host);
    }
    if (count(PortAnswer::kNobodyListens) == all) {
        return fmt::format(
            "{} is there, but nobody listens: start 'thimble link-test --listen --base-port {}' there", host,
            base_port);
    }
    if (count(PortAnswer::kSilent) > 0) {
        return "some ports are silent while others speak: a firewall that lets only some through; allow UDP "
               "on all of "
               "the session's ports";
    }
    return "nobody listens at some ports: does another program than 'thimble link-test --listen' answer at "
           "the "
           "others, or one with another base port?";
}

}  // namespace thimble
