#include "netem/commands/network_options.hpp"

#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "netem/profiles/profiles.hpp"
#include "netem/relay/control_text.hpp"

namespace thimble {
namespace {

void take_words(LinkSettings& link, Way way, const std::string& words, std::uint64_t& seed) {
    if (words.empty()) return;
    TcWays read = parse_tc(words, way);
    for (const std::string& note : read.notes) spdlog::info(note);
    link = std::move(way == Way::kUp ? read.up : read.down);
    seed = read.seed.value_or(seed);
}

// Changes of the profile keep them.
void assign_always(Network& network, const std::vector<std::string>& assignments) {
    network.links = assign(network.links, assignments);
    for (LinkChange& change : network.timelines.up)
        change.settings = assign({change.settings, network.links.down}, assignments).up;
    for (LinkChange& change : network.timelines.down)
        change.settings = assign({network.links.up, change.settings}, assignments).down;
}

}  // namespace

void add_network_options(CLI::App& app, NetworkOptions& options) {
    app.add_option("-p,--profile", options.profile,
                   "the network: a built-in name (" + fmt::format("{}", fmt::join(profile_names(), ", ")) +
                       "), a TOML file, or words of tc in quotes")
        ->type_name("NAME|FILE|WORDS");
    app.add_option("--link", options.link,
                   "change single settings of it for the whole time, e.g. up.delay_s=0.05 loss=0.01; without "
                   "up. or down. in both directions")
        ->type_name("KEY=VALUE");
    app.add_option("-s,--seed", options.seed,
                   "random seed; the same seed gives each packet the same fate (default 1, or tc's seed)");
}

Network read_network(const NetworkOptions& options) {
    Network network;
    if (!options.profile.empty()) {
        LinkProfile profile = load_profile(options.profile);
        for (const std::string& note : profile.notes) spdlog::info(note);
        network.links = {std::move(profile.up), std::move(profile.down)};
        network.timelines = {std::move(profile.up_changes), std::move(profile.down_changes)};
        network.seed = profile.seed.value_or(network.seed);
    }
    take_words(network.links.up, Way::kUp, options.uplink, network.seed);
    take_words(network.links.down, Way::kDown, options.downlink, network.seed);
    network.seed = options.seed.value_or(network.seed);
    if (!options.uplink.empty()) network.timelines.up.clear();  // those words are the whole link
    if (!options.downlink.empty()) network.timelines.down.clear();
    assign_always(network, options.link);
    return network;
}

SelftestSettings selftest_settings(const NetworkOptions& options, double length_s) {
    Network network = read_network(options);
    SelftestSettings settings;
    settings.links = std::move(network.links);
    settings.timelines = std::move(network.timelines);
    settings.seed = network.seed;
    if (length_s > 0) settings.length = from_seconds(length_s);
    return settings;
}

int run_and_print(const SelftestSettings& settings, SelftestPath& path, bool json) {
    const SelftestResult result = run_selftest(settings, path);
    fmt::print("{}", json ? json_text(describe(result), 2) + "\n" : selftest_text(result));
    return static_cast<int>(result.verdict == SelftestVerdict::kFail ? ExitCode::kRunFailed : ExitCode::kOk);
}

}  // namespace thimble
