#include "netem/commands/profile_option.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "netem/formats/tc_text.hpp"
#include "netem/profiles/profiles.hpp"
#include "netem/relay/control_text.hpp"

namespace thimble {

void add_profile_options(CLI::App& app, ProfileOptions& options) {
    app.add_option("-p,--profile", options.profile,
                   "the network: a name (" + fmt::format("{}", fmt::join(profile_names(), ", ")) +
                       "), a TOML file, or tc's words in quotes")
        ->type_name("NAME|FILE|WORDS");
    app.add_option(
           "--link", options.link,
           "single settings on top of it, e.g. up.delay_s=0.05 loss=0.01; both ways without up. or down.")
        ->type_name("KEY=VALUE");
}

Network read_profile(const ProfileOptions& options) {
    Network network;
    if (!options.profile.empty()) {
        LinkProfile profile = load_profile(options.profile);
        for (const std::string& note : profile.notes) spdlog::info(note);
        network.links = {std::move(profile.up), std::move(profile.down)};
        network.timelines = {std::move(profile.up_changes), std::move(profile.down_changes)};
    }
    network.links = assign(network.links, options.link);
    return network;
}

void print_tc_commands(const LinkPair& links, const std::string& device) {
    const auto print_way = [&](const char* way, const LinkSettings& link) {
        const TcCommands tc = print_tc(link, device);
        fmt::print("# {}\n", way);
        for (const std::string& command : tc.commands) fmt::print("{}\n", command);
        for (const std::string& gap : tc.cannot) fmt::print("# not the same: {}\n", gap);
    };
    print_way("up", links.up);
    print_way("down", links.down);
}

}  // namespace thimble
