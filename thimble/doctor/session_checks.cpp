#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "session/launch/remote_script.hpp"
#include "thimble/doctor/checks.hpp"

namespace thimble {
namespace {

std::string last_port(const PortFacts& ports) { return std::to_string(ports.first + ports.count - 1); }

std::string holder_of(const TakenPort& taken) {
    if (taken.process == 0) return fmt::format("{} (by another user's program)", taken.port);
    return fmt::format("{} (by {}, process {})", taken.port, taken.program, taken.process);
}

// Suggests other ports, not the end of a foreign program.
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

Diagnosis check_session(const Facts& facts) {
    const SessionFacts& session = facts.session;
    Diagnosis finding{"session", session.problem_code};
    if (!session.problem.empty())
        return finding.is(Severity::kFault, session.problem, "thimble check " + shell_word(session.file));
    if (!session.energy.empty()) return finding.is(Severity::kWarning, session.energy);
    return finding.is(Severity::kOk, session.file.empty()
                                         ? "the default session (name a session file to check that one)"
                                         : fmt::format("{} is good", session.file));
}

Diagnosis check_protection(const Facts& facts) {
    const ProtectionFacts& protection = facts.protection;
    Diagnosis finding{"protection", protection.code};
    if (!protection.problem.empty())
        return finding.is(Severity::kFault, protection.problem, protection.remedy);
    return finding.is(Severity::kOk, fmt::format("[security] mode = \"{}\"", protection.mode));
}

Diagnosis check_programs(const Facts& facts) {
    const ProgramFacts& programs = facts.programs;
    Diagnosis finding{"programs", ExitCode::kRunFailed};
    std::vector<std::string> missing, others;
    for (const auto& node : programs.nodes) {
        if (node.version.empty()) {
            missing.push_back(node.name);
        } else if (node.version != programs.own_version) {
            others.push_back(fmt::format("{} {}", node.name, node.version));
        }
    }
    if (missing.empty() && others.empty())
        return finding.is(Severity::kOk, fmt::format("thimble {} and its {} nodes", programs.own_version,
                                                     programs.nodes.size()));
    return finding.is(
        Severity::kFault,
        missing.empty()
            ? fmt::format("{} and thimble {} differ: use the same version of both", fmt::join(others, ", "),
                          programs.own_version)
            : fmt::format("no {} that runs in {}, where thimble looks for the programs of a session",
                          fmt::join(missing, ", "), programs.folder),
        "cmake --build --preset release --target programs");
}

Diagnosis check_ports(const Facts& facts) {
    const PortFacts& ports = facts.ports;
    Diagnosis finding{"ports", ExitCode::kNetwork};
    if (!ports.taken.empty()) {
        return finding.is(Severity::kFault,
                          fmt::format("{} of the UDP ports {} to {} are in use: {}{}", ports.taken.size(),
                                      ports.first, last_port(ports), holder_of(ports.taken.front()),
                                      ports.taken.size() > 1 ? " and others" : ""),
                          free_ports_command(ports));
    }
    if (!ports.loopback_passes) {
        return finding.is(
            Severity::kFault,
            "a datagram to 127.0.0.1 did not arrive: the loopback interface is down or filtered",
            "sudo ip link set lo up");
    }
    return finding.is(Severity::kOk,
                      fmt::format("UDP ports {} to {} are free, and the loopback interface works",
                                  ports.first, last_port(ports)));
}

Diagnosis check_firewall(const Facts& facts) {
    Diagnosis finding{"firewall", ExitCode::kNetwork};
    const std::string first = std::to_string(facts.ports.first), last = last_port(facts.ports);
    switch (facts.firewall.kind) {
        case FirewallKind::kNone:
            return finding.is(Severity::kOk, "none found (only root can read nftables' rules)");
        case FirewallKind::kUfw:
            finding.is(Severity::kWarning, "ufw is active",
                       fmt::format("sudo ufw allow {}:{}/udp", first, last));
            break;
        case FirewallKind::kFirewalld:
            finding.is(Severity::kWarning, "firewalld is active",
                       fmt::format("sudo firewall-cmd --permanent --add-port={}-{}/udp && "
                                   "sudo firewall-cmd --reload",
                                   first, last));
            break;
        case FirewallKind::kNftables:
            finding.is(Severity::kWarning,
                       fmt::format("the nftables chain {} drops everything that no rule accepts",
                                   facts.firewall.chain),
                       fmt::format("sudo nft insert rule {} udp dport {}-{} accept", facts.firewall.chain,
                                   first, last));
            break;
    }
    if (!facts.session.several_machines)
        return finding.adds(Severity::kOk, "; a session on this machine alone is not affected");
    return finding.adds(Severity::kWarning,
                        ", and this session needs UDP from other machines ('thimble link-test' tests it)",
                        finding.remedy);
}

Diagnosis check_software(const Facts& facts) {
    const ProgramFacts& programs = facts.programs;
    Diagnosis finding{"software", ExitCode::kRunFailed};
    finding.says = fmt::format("{}, {}", programs.system.empty() ? "unknown system" : programs.system,
                               programs.gnuplot.empty() ? "no gnuplot" : programs.gnuplot);
    if (!programs.gnuplot.empty()) return finding;
    return finding.adds(Severity::kWarning, ": reports would have no figures",
                        "sudo apt-get install gnuplot-nox");
}

Diagnosis check_python(const Facts& facts) {
    const ProgramFacts& programs = facts.programs;
    Diagnosis finding{"python", ExitCode::kRunFailed};
    if (programs.python.empty())
        return finding.is(Severity::kNote, "python3 cannot import thimble (docs/python.md)",
                          "sudo apt-get install ./out/package/python3-thimble_*.deb");
    finding.says = fmt::format("python3 imports thimble {}", programs.python);
    if (programs.python == programs.own_version) return finding;
    return finding.adds(Severity::kWarning, fmt::format(", but this is thimble {}", programs.own_version),
                        "python3 -c 'import thimble; print(thimble.__file__)'");
}

}  // namespace thimble
