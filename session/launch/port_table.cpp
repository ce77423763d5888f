#include <algorithm>

#include <fmt/format.h>

#include "session/launch/unit_files.hpp"

namespace thimble {
namespace {

std::string place(const NetworkSettings& network, const LaunchSettings& launch, Role role) {
    const std::string& machine = launch.machine(role);
    return fmt::format("{} ({})", network.host(role), machine.empty() ? "this machine" : machine);
}

bool on_one_machine(const LaunchSettings& launch) {
    return std::all_of(launch.machines.begin(), launch.machines.end(),
                       [&](const std::string& machine) { return machine == launch.machines.front(); });
}

}  // namespace

std::string firewall_table(const NetworkSettings& network, const LaunchSettings& launch) {
    std::string text =
        "| UDP port | listens | hears | what | at | from |\n| --- | --- | --- | --- | --- | --- |\n";
    for (const Port port : kEveryPort) {
        const Flow& from = flow(port);
        const bool crosses = from.from_all ? !on_one_machine(launch)
                                           : launch.machine(from.listens) != launch.machine(from.hears);
        if (!crosses) continue;
        text +=
            fmt::format("| {} | {} | {} | {} | {} | {} |\n", network.at(port).port, to_string(from.listens),
                        to_string(from.hears), from.what, place(network, launch, from.listens),
                        from.from_all ? "every machine" : place(network, launch, from.hears));
    }
    return text;
}

}  // namespace thimble
