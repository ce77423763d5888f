#include "experiment/launch/port_table.hpp"

#include <fmt/format.h>

namespace thimble {
namespace {

std::string line(const NetworkSettings& network, Port port, const std::string& more) {
    const Flow& from = flow(port);
    return fmt::format("| {} | {} | {} | {} |{}\n", network.at(port).port, to_string(from.listens),
                       to_string(from.hears), from.what, more);
}

template <class Each>
void for_each_port(Each each) {
    for (std::uint16_t i = 0; i < static_cast<std::uint16_t>(Port::kCount); ++i) each(static_cast<Port>(i));
}

std::string place(const NetworkSettings& network, const LaunchSettings& launch, Role role) {
    const std::string& machine = launch.machine(role);
    return fmt::format("{} ({})", network.hosts[static_cast<std::size_t>(role)],
                       machine.empty() ? "this machine" : machine);
}

}  // namespace

std::string port_table(const NetworkSettings& network) {
    std::string text = "| UDP port | listens | hears | what |\n| --- | --- | --- | --- |\n";
    for_each_port([&](Port port) { text += line(network, port, ""); });
    return text;
}

std::string firewall_table(const NetworkSettings& network, const LaunchSettings& launch) {
    std::string text =
        "| UDP port | listens | hears | what | at | from |\n| --- | --- | --- | --- | --- | --- |\n";
    for_each_port([&](Port port) {
        const Flow& from = flow(port);
        if (launch.machine(from.listens) == launch.machine(from.hears)) return;
        text += line(network, port,
                     fmt::format(" {} | {} |", place(network, launch, from.listens),
                                 place(network, launch, from.hears)));
    });
    return text;
}

}  // namespace thimble
