#include <fmt/format.h>

#include "session/launch/unit_files.hpp"

namespace thimble {
namespace {

std::string place(const NetworkSettings& network, const LaunchSettings& launch, Role role) {
    const std::string& machine = launch.machine(role);
    return fmt::format("{} ({})", network.host(role), machine.empty() ? "this machine" : machine);
}

}  // namespace

std::string firewall_table(const NetworkSettings& network, const LaunchSettings& launch) {
    std::string text =
        "| UDP port | listens | hears | what | at | from |\n| --- | --- | --- | --- | --- | --- |\n";
    for (const Port port : kEveryPort) {
        const Flow& from = flow(port);
        const bool crosses = from.from_all ? launch.anywhere_else()
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
