// What the links of a relay shall do, as people say it on a command line. The one place where words become LinkSettings.
#pragma once

#include <string>
#include <vector>

#include "netem/relay/relay_settings.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace thimble {

struct ProfileOptions {
    std::string config;             // TOML with tables [up] and [down]
    std::vector<std::string> link;  // assignments as for `thimble-netem set`, after the above
};

void add_profile_options(CLI::App& app, ProfileOptions& options);

// Throws Error (usage).
LinkPair read_profile(const ProfileOptions& options);

}  // namespace thimble
