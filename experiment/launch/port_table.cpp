#include "experiment/launch/port_table.hpp"

#include <fmt/format.h>

namespace thimble {
namespace {

std::string line(const NetworkSettings& network, Port port, const std::string& more) {
    const Flow& from = flow(port);
    return fmt::format("| {} | {} | {} | {} |{}\n", network.at(port).port, to_string(from.listens),
                       to_string(from.hears), from.what, more);
}

std::string place(const NetworkSettings& network, const LaunchSettings& launch, Role role) {
    const std::string& machine = launch.machine(role);
    return fmt::format("{} ({})", network.host(role), machine.empty() ? "this machine" : machine);
}

}  // namespace

std::string port_table(const NetworkSettings& network) {
    std::string text = "| UDP port | listens | hears | what |\n| --- | --- | --- | --- |\n";
    for (const Port port : kEveryPort) text += line(network, port, "");
    return text;
}

std::string firewall_table(const NetworkSettings& network, const LaunchSettings& launch) {
    std::string text =
        "| UDP port | listens | hears | what | at | from |\n| --- | --- | --- | --- | --- | --- |\n";
    for (const Port port : kEveryPort) {
        const Flow& from = flow(port);
        if (launch.machine(from.listens) == launch.machine(from.hears)) continue;
        text += line(network, port,
                     fmt::format(" {} | {} |", place(network, launch, from.listens),
                                 place(network, launch, from.hears)));
    }
    return text;
}

}  // namespace thimble
