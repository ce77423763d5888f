// The links of a relay as command-line options. The one place where words become LinkSettings.
#pragma once

#include <string>
#include <vector>

#include "netem/relay/relay_settings.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace thimble {

struct ProfileOptions {
    std::string profile;            // a name, a file or tc's words (profiles.hpp)
    std::vector<std::string> link;  // assignments as for `thimble-netem set`, on top of it
};

struct Network {
    LinkPair links;
    TimelinePair timelines;
};

void add_profile_options(CLI::App& app, ProfileOptions& options);

// Throws Error (usage; data for a file that a profile names).
Network read_profile(const ProfileOptions& options);

// The same for the kernel's netem on `device`, and what it does not do.
void print_tc_commands(const LinkPair& links, const std::string& device);

}  // namespace thimble
