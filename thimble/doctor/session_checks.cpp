#include <algorithm>

#include <fmt/format.h>

#include "thimble/doctor/checks.hpp"

namespace thimble {
namespace {

constexpr const char* kBuildCommand = "cmake --build --preset release --target programs";

std::string last_port(const PortFacts& ports) { return std::to_string(ports.first + ports.count - 1); }

std::string holder_of(const TakenPort& taken) {
    if (taken.process == 0) return fmt::format("{} (by another user's program)", taken.port);
    return fmt::format("{} (by {}, process {})", taken.port, taken.program, taken.process);
}

// Ending a program that is not ours to end is no remedy: then the session moves.
std::string free_ports_command(const PortFacts& ports) {
    std::vector<long> processes;
    for (const TakenPort& taken : ports.taken) {
        if (taken.process == 0 || taken.program.rfind("thimble", 0) != 0) {
            const int next = ports.first + ports.count;
            return fmt::format("thimble run SESSION.toml --base-port {}",
                               next + ports.count < 65536 ? next : 20000);
        }
        if (std::find(processes.begin(), processes.end(), taken.process) == processes.end())
            processes.push_back(taken.process);
    }
    return fmt::format("kill {}", fmt::join(processes, " "));
}

}  // namespace

Diagnosis check_session(const SessionFacts& session) {
    Diagnosis finding{"session", Severity::kOk, "", "", ExitCode::kUsage};
    if (session.problem.empty()) {
        finding.says = session.file.empty() ? "the default session (give a session file to look at another)"
                                            : fmt::format("{} is good", session.file);
        return finding;
    }
    finding.severity = Severity::kFault;
    finding.says = session.problem;
    finding.remedy = fmt::format("thimble check {}", session.file);
    return finding;
}

Diagnosis check_programs(const ProgramFacts& programs) {
    Diagnosis finding{"programs", Severity::kOk, "", "", ExitCode::kRunFailed};
    std::vector<std::string> missing, others;
    for (const auto& node : programs.nodes) {
        if (node.version.empty()) missing.push_back(node.name);
        if (!node.version.empty() && node.version != programs.own_version)
            others.push_back(fmt::format("{} {}", node.name, node.version));
    }
    if (missing.empty() && others.empty()) {
        finding.says =
            fmt::format("thimble {} and its {} nodes", programs.own_version, programs.nodes.size());
        return finding;
    }
    finding.severity = Severity::kFault;
    finding.remedy = kBuildCommand;
    if (!missing.empty()) {
        finding.says = fmt::format("no {} that runs in {}, where thimble looks for its nodes",
                                   fmt::join(missing, ", "), programs.folder);
    } else {
        finding.says = fmt::format("{} beside thimble {}: all must be of one version",
                                   fmt::join(others, ", "), programs.own_version);
    }
    return finding;
}

Diagnosis check_ports(const PortFacts& ports) {
    Diagnosis finding{"ports", Severity::kOk, "", "", ExitCode::kNetwork};
    finding.says = fmt::format("UDP ports {} to {} are free, and the loopback passes datagrams", ports.first,
                               last_port(ports));
    if (!ports.loopback_passes) {
        finding.severity = Severity::kFault;
        finding.says = "a datagram sent to 127.0.0.1 did not arrive: the loopback is down, or filtered";
        finding.remedy = "sudo ip link set lo up";
    }
    if (!ports.taken.empty()) {
        finding.severity = Severity::kFault;
        finding.says = fmt::format("{} of UDP ports {} to {} taken: {}", ports.taken.size(), ports.first,
                                   last_port(ports), holder_of(ports.taken.front()));
        if (ports.taken.size() > 1) finding.says += " and others";
        finding.remedy = free_ports_command(ports);
    }
    return finding;
}

Diagnosis check_firewall(const FirewallFacts& firewall, const PortFacts& ports, bool several_machines) {
    Diagnosis finding{"firewall", Severity::kOk, "", "", ExitCode::kNetwork};
    const std::string first = std::to_string(ports.first), last = last_port(ports);
    switch (firewall.kind) {
        case FirewallKind::kNone:
            finding.says = "none was seen (nftables' rules can be read by root only)";
            return finding;
        case FirewallKind::kUfw:
            finding.says = "ufw is active";
            finding.remedy = fmt::format("sudo ufw allow {}:{}/udp", first, last);
            break;
        case FirewallKind::kFirewalld:
            finding.says = "firewalld is active";
            finding.remedy = fmt::format(
                "sudo firewall-cmd --permanent --add-port={}-{}/udp && "
                "sudo firewall-cmd --reload",
                first, last);
            break;
        case FirewallKind::kNftables:
            finding.says = fmt::format("the nftables chain {} drops what no rule accepts", firewall.chain);
            finding.remedy =
                fmt::format("sudo nft insert rule {} udp dport {}-{} accept", firewall.chain, first, last);
            break;
    }
    if (several_machines) {
        finding.severity = Severity::kWarning;
        finding.says += ", and this session needs UDP from other machines ('thimble link-test' shows which)";
    } else {
        finding.says += "; a session on this machine alone does not pass it";
        finding.remedy.clear();
    }
    return finding;
}

Diagnosis check_software(const ProgramFacts& programs) {
    Diagnosis finding{"software", Severity::kOk, "", "", ExitCode::kRunFailed};
    finding.says = fmt::format("{}, {}", programs.system.empty() ? "unknown system" : programs.system,
                               programs.gnuplot.empty() ? "no gnuplot" : programs.gnuplot);
    if (programs.gnuplot.empty()) {
        finding.severity = Severity::kWarning;
        finding.says += ": reports would be without figures";
        finding.remedy = "sudo apt-get install gnuplot-nox";
    }
    return finding;
}

}  // namespace thimble
