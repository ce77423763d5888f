#include <fmt/format.h>

#include "common/runtime/udp_channel.hpp"
#include "session/launch/unit_files.hpp"

namespace thimble {
namespace {

std::string place(const NetworkSettings& network, const LaunchSettings& launch, Role role) {
    const std::string& machine = launch.machine(role);
    const char* const otherwise = role == Role::kExperimenter ? "the view's machine" : "this machine";
    return fmt::format("{} ({})", network.host(role), machine.empty() ? otherwise : machine);
}

bool view_elsewhere(const NetworkSettings& network) {
    const std::string& view = network.host(Role::kExperimenter);
    return view != network.host(Role::kSession) && !means_this_machine(view);
}

bool is_of_view(const Flow& from) {
    return from.listens == Role::kExperimenter || from.hears == Role::kExperimenter;
}

bool crosses(const Flow& from, const LaunchSettings& launch, bool view) {
    if (from.from_all) return view || launch.anywhere_else();
    return is_of_view(from) ? view : launch.machine(from.listens) != launch.machine(from.hears);
}

}  // namespace

std::string firewall_table(const NetworkSettings& network, const LaunchSettings& launch) {
    std::string text =
        "| UDP port | listens | hears | what | at | from |\n| --- | --- | --- | --- | --- | --- |\n";
    const bool view = view_elsewhere(network);
    for (const Port port : kEveryPort) {
        const Flow& from = flow(port);
        if (!crosses(from, launch, view)) continue;
        text +=
            fmt::format("| {} | {} | {} | {} | {} | {} |\n", network.at(port).port, to_string(from.listens),
                        to_string(from.hears), from.what, place(network, launch, from.listens),
                        from.from_all ? "every machine" : place(network, launch, from.hears));
    }
    return text;
}

}  // namespace thimble
