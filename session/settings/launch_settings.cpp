#include "session/settings/launch_settings.hpp"

#include <algorithm>
#include <cctype>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/udp_channel.hpp"

namespace thimble {
namespace {

constexpr std::string_view kHost = "{host}";

// Any destination of ssh, any name of a namespace or container.
bool is_plain(const std::string& machine) {
    if (!machine.empty() && machine.front() == '-') return false;
    return std::none_of(machine.begin(), machine.end(),
                        [](unsigned char c) { return std::isspace(c) != 0 || std::iscntrl(c) != 0; });
}

std::string where(const std::string& machine) {
    return machine.empty() ? "this machine" : fmt::format("'{}'", machine);
}

void check_flow(const LaunchSettings& launch, const NetworkSettings& network, Role a, Role b) {
    const auto &machine_a = launch.machine(a), &machine_b = launch.machine(b);
    const std::string& host = network.host(a);
    if (means_this_machine(host)) {
        throw Error(ExitCode::kUsage,
                    "[network].host_{} is {}, which every machine takes for itself, but {} runs on {} and "
                    "{}, which it talks to, on {}: give the address that the others reach it by",
                    to_string(a), host, to_string(a), where(machine_a), to_string(b), where(machine_b));
    }
    if (host == network.host(b)) {
        throw Error(ExitCode::kUsage,
                    "[network].host_{} and host_{} are both {}, but {} runs on {} and {} on {}: each machine "
                    "has an address of its own",
                    to_string(a), to_string(b), host, to_string(a), where(machine_a), to_string(b),
                    where(machine_b));
    }
}

}  // namespace

bool LaunchSettings::anywhere_else() const {
    return std::any_of(machines.begin(), machines.end(), [](const auto& name) { return !name.empty(); });
}

LaunchSettings read_launch_settings(const ConfigFile& file) {
    const ConfigTable table = file.table("launch");
    LaunchSettings s;
    std::set<std::string> others;
    for (std::size_t i = 1; i < s.machines.size(); ++i) {
        if (static_cast<Role>(i) == Role::kExperimenter) continue;  // no node: its user starts that view
        const std::string key = std::string("machine_") + to_string(static_cast<Role>(i));
        table.read(key, s.machines[i], "As exec takes it: \"me@lab2\"; empty: this machine.");
        if (!is_plain(s.machines[i]))
            table.fail(key, "must be a name without blanks that begins with no '-'");
        if (!s.machines[i].empty()) others.insert(s.machines[i]);
    }
    table.read("exec", s.exec,
               "Runs a command on {host}, connected to its three standard streams; or --exec. No quotes.");
    if (exec_words(s, "x").empty()) table.fail("exec", "is empty; leave it out for ssh");
    if (others.size() > 1 && s.exec.find(kHost) == std::string::npos)
        table.fail("exec", "does not say {host}, so it would start every node on the same machine");
    table.read("programs", s.programs,
               "A folder there, of the programs thimble-*; empty: sought in PATH there; or --programs.");
    table.read("reach_s", s.reach, 1, 600, "For all machines to be reached.");
    table.read("lease_s", s.lease, 2, 3600,
               "A node ends itself after so long without a sign of the launcher.");
    table.read("shares_loopback", s.shares_loopback,
               "The machines have this one's 127.0.0.1 (containers, other users), so [network] may name it.");
    return s;
}

std::vector<std::string> exec_words(const LaunchSettings& launch, const std::string& machine) {
    std::istringstream text(launch.exec);
    std::vector<std::string> words;
    for (std::string word; text >> word;) {
        for (std::size_t at = 0; (at = word.find(kHost, at)) != std::string::npos; at += machine.size())
            word.replace(at, kHost.size(), machine);
        words.push_back(word);
    }
    return words;
}

void check_hosts(const LaunchSettings& launch, const NetworkSettings& network) {
    if (launch.shares_loopback) return;
    for (const Port port : kEveryPort) {
        const Flow& between = flow(port);
        if (launch.machine(between.listens) == launch.machine(between.hears)) continue;
        check_flow(launch, network, between.listens, between.hears);
        check_flow(launch, network, between.hears, between.listens);
    }
}

}  // namespace thimble
