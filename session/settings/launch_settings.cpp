#include "session/settings/launch_settings.hpp"

#include <algorithm>
#include <cctype>
#include <set>
#include <sstream>
#include <unistd.h>

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
                    "[network].host_{} is {}, which means this machine on every machine, but {} runs on {} "
                    "and {}, which it talks to, on {}: set the address by which the others reach it",
                    to_string(a), host, to_string(a), where(machine_a), to_string(b), where(machine_b));
    }
    if (host == network.host(b)) {
        throw Error(ExitCode::kUsage,
                    "[network].host_{} and host_{} are both {}, but {} runs on {} and {} on {}: each machine "
                    "has its own address",
                    to_string(a), to_string(b), host, to_string(a), where(machine_a), to_string(b),
                    where(machine_b));
    }
}

// A view of the experimenter is no node: its user starts it.
bool is_node(Role role) { return role != Role::kSession && role != Role::kExperimenter; }

std::string program_key(Role role) { return std::string("program_") + to_string(role); }

void read_own_program(const ConfigFile& file, const ConfigTable& table, Role role, LaunchSettings& s) {
    const std::string key = program_key(role);
    std::string name;
    table.read(key, name,
               "Your own program instead of Thimble's, on this machine; a relative path starts at this "
               "file's folder (docs/clocks.md).");
    if (name.empty()) return;
    const auto path = std::filesystem::absolute(file.folder() / name);
    if (!std::filesystem::is_regular_file(path) || access(path.c_str(), X_OK) != 0)
        table.fail(
            key,
            "is '{}', but there is no program of that name: is the file there and executable (chmod +x)?",
            path.string());
    if (s.anywhere_else())
        table.fail(key, "works in sessions on one machine only: remove the keys machine_... from [launch]");
    s.own_programs[static_cast<std::size_t>(role)] = path;
}

}  // namespace

bool LaunchSettings::anywhere_else() const {
    return std::any_of(machines.begin(), machines.end(), [](const auto& name) { return !name.empty(); });
}

std::string LaunchSettings::own_program_key() const {
    for (std::size_t i = 0; i < own_programs.size(); ++i) {
        if (!own_programs[i].empty()) return program_key(static_cast<Role>(i));
    }
    return {};
}

void LaunchSettings::require_no_own_program(std::string_view command) const {
    if (const std::string key = own_program_key(); !key.empty())
        throw Error(ExitCode::kUsage,
                    "[launch] {} names a program of yours, and {} does not start it: remove that key; "
                    "'thimble run --clock lock-step' starts such programs (docs/clocks.md)",
                    key, command);
}

LaunchSettings read_launch_settings(const ConfigFile& file) {
    const ConfigTable table = file.table("launch");
    LaunchSettings s;
    std::set<std::string> others;
    for (std::size_t i = 0; i < s.machines.size(); ++i) {
        if (!is_node(static_cast<Role>(i))) continue;
        const std::string key = std::string("machine_") + to_string(static_cast<Role>(i));
        table.read(key, s.machines[i],
                   "Machine of this program, as exec takes it: \"me@lab2\"; empty: this machine.");
        if (!is_plain(s.machines[i]))
            table.fail(key, "must be a name without blanks that begins with no '-'");
        if (!s.machines[i].empty()) others.insert(s.machines[i]);
    }
    table.read("exec", s.exec,
               "Command that runs a command on {host}, connected to its three standard streams; --exec "
               "replaces it. Without quotes.");
    if (exec_words(s, "x").empty()) table.fail("exec", "is empty; remove the key to use ssh");
    if (others.size() > 1 && s.exec.find(kHost) == std::string::npos)
        table.fail("exec", "does not contain {host}, so it would start every program on the same machine");
    table.read("programs", s.programs,
               "Folder of the programs thimble-* on the other machines; empty: searched for in PATH there. "
               "--programs replaces it.");
    table.read("reach_s", s.reach, 1, 600, "Longest time to reach all machines.");
    table.read("lease_s", s.lease, 2, 3600,
               "A program ends itself after this time without a message from the launcher.");
    table.read("shares_loopback", s.shares_loopback,
               "true: the machines share 127.0.0.1 with this one (containers, other users), so [network] may "
               "name it.");
    for (std::size_t i = 0; i < s.own_programs.size(); ++i) {
        if (is_node(static_cast<Role>(i))) read_own_program(file, table, static_cast<Role>(i), s);
    }
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
    for (const Port port : kEveryPort) {
        const Flow& between = flow(port);
        if (launch.shares_loopback || launch.machine(between.listens) == launch.machine(between.hears))
            continue;
        check_flow(launch, network, between.listens, between.hears);
        check_flow(launch, network, between.hears, between.listens);
    }
    if (network.security.mode != SecurityMode::kUserKey || !launch.anywhere_else()) return;
    throw Error(
        ExitCode::kUsage,
        "[launch] names other machines, which do not have the key of [security] mode \"user-key\": make one "
        "with 'thimble keygen', copy it to each machine and set mode = \"lab-key\" (docs/security.md)");
}

}  // namespace thimble
