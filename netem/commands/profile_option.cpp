#include "netem/commands/profile_option.hpp"

#include <CLI/CLI.hpp>

#include "common/config.hpp"
#include "netem/link_reader.hpp"
#include "netem/relay/control_words.hpp"

namespace thimble {
namespace {

LinkPair read_config(const std::string& path) {
    if (path.empty()) return {};
    const ConfigFile file = ConfigFile::load(path);
    const LinkPair links{read_link_settings(file.table("up")), read_link_settings(file.table("down"))};
    file.finish();
    return links;
}

}  // namespace

void add_profile_options(CLI::App& app, ProfileOptions& options) {
    app.add_option("-c,--config", options.config, "what the links do: TOML with tables [up] and [down]")
        ->type_name("FILE");
    app.add_option("--link", options.link,
                   "single settings, e.g. up.delay_s=0.05 loss=0.01; both ways without up. or down.")
        ->type_name("KEY=VALUE");
}

LinkPair read_profile(const ProfileOptions& options) {
    return assign(read_config(options.config), options.link);
}

}  // namespace thimble
