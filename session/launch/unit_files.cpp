#include "session/launch/unit_files.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"
#include "session/launch/node_kinds.hpp"

namespace thimble {
namespace {

// A specifier begins with %, a variable with $ (systemd.service(5), "Command lines").
std::string unit_word(const std::string& text) {
    std::string word;
    for (const char c : text) {
        if (c == '%' || c == '$') word += c;
        if (c == '"' || c == '\\') word += '\\';
        word += c;
    }
    return fmt::format("\"{}\"", word);
}

bool is_address(const std::string& host) {
    in_addr address{};
    return inet_pton(AF_INET, host.c_str(), &address) == 1;
}

// All hosts of the session, because a stop goes from each to each, and this machine, where a device's own service may be.
// None where a host is a name, because systemd does not resolve names.
std::string address_rules(const NetworkSettings& network) {
    const std::set<std::string> peers(network.hosts.begin(), network.hosts.end());
    if (!std::all_of(peers.begin(), peers.end(), is_address)) return "";
    return fmt::format("IPAddressDeny=any\nIPAddressAllow=localhost {}\n", fmt::join(peers, " "));
}

constexpr const char* kUnit = R"({comment}
[Unit]
Description=Thimble: {role}
Wants=network-online.target
After=network-online.target

[Service]
# Ready once it listens; a loop that does not turn for two seconds is started anew.
Type=notify
NotifyAccess=main
WatchdogSec=2
ExecStart={command}
Restart=on-failure
RestartSec=1
# The node limits its start itself: a user may have to home the handle first (homing_limit_s).
TimeoutStartSec=infinity
TimeoutStopSec=5

# Real-time scheduling without being root.
LimitRTPRIO={priority}
RestrictRealtime=no

# It reads one folder, writes nothing, opens no device and talks UDP with its peers. A node that holds a real handle
# needs its device: PrivateDevices=no and DeviceAllow=.
DynamicUser=yes
NoNewPrivileges=yes
CapabilityBoundingSet=
AmbientCapabilities=
ProtectSystem=strict
ProtectHome={protect_home}
PrivateTmp=yes
PrivateDevices=yes
ProtectClock=yes
ProtectControlGroups=yes
ProtectHostname=yes
ProtectKernelLogs=yes
ProtectKernelModules=yes
ProtectKernelTunables=yes
ProtectProc=invisible
ProcSubset=pid
LockPersonality=yes
MemoryDenyWriteExecute=yes
RemoveIPC=yes
RestrictNamespaces=yes
RestrictSUIDSGID=yes
RestrictAddressFamilies=AF_INET AF_UNIX AF_CAN
SystemCallArchitectures=native
SystemCallFilter=@system-service
SystemCallErrorNumber=EPERM
{addresses}
[Install]
WantedBy=multi-user.target
)";

// Root owns the key. systemd hands it to the service's user (systemd.exec(5), "Credentials").
std::string credential(const SecuritySettings& security) {
    if (security.mode == SecurityMode::kUserKey) {
        throw Error(ExitCode::kUsage,
                    "[security] mode \"user-key\" does not work for services, which run as different users: "
                    "make a key with 'thimble keygen' and set mode = \"lab-key\" (docs/machines.md)");
    }
    if (security.mode == SecurityMode::kNone) return "";
    return fmt::format("LoadCredential=lab.key:{}/lab.key\n", kSessionFolder);
}

UnitFile unit(const UnitPlan& plan, const NodeKind& node) {
    UnitFile file;
    file.machine = plan.launch.machine(node.role);
    file.name = std::string(node.program) + ".service";
    const std::string folder = plan.launch.programs.empty() ? "/usr/bin" : plan.launch.programs;
    const std::string where = file.machine.empty() ? "this machine" : file.machine;
    file.text = fmt::format(
        kUnit,
        fmt::arg("comment", fmt::format("# {}/{} on {}. Session file: {}/{}", kUnitFolder, file.name, where,
                                        kSessionFolder, plan.session)),
        fmt::arg("role", to_string(node.role)), fmt::arg("priority", plan.runtime.priority),
        fmt::arg("command", fmt::format("{} {} --base-port {}", unit_word(folder + "/" + node.program),
                                        unit_word(fmt::format("{}/{}", kSessionFolder, plan.session)),
                                        plan.network.base_port)),
        fmt::arg("protect_home",
                 folder.rfind("/home/", 0) == 0 || folder.rfind("/root/", 0) == 0 ? "read-only" : "yes"),
        fmt::arg("addresses", credential(plan.network.security) + address_rules(plan.network)));
    return file;
}

}  // namespace

std::vector<UnitFile> unit_files(const UnitPlan& plan) {
    std::vector<UnitFile> files;
    files.reserve(kNodes.size());
    for (const NodeKind& node : kNodes) files.push_back(unit(plan, node));
    return files;
}

}  // namespace thimble
