// The options that name a network, alike for the relay, shell and pair.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "netem/relay/selftest.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace thimble {

struct NetworkOptions {
    std::string profile;                // a name, a file or tc's words (profiles.hpp)
    std::string uplink, downlink;       // tc's words for one way each
    std::vector<std::string> link;      // assignments as for `thimble-netem set`, on top of it
    std::optional<std::uint64_t> seed;  // without it that of tc's words, or 1
};

struct Network {
    LinkPair links;
    TimelinePair timelines;
    std::uint64_t seed = 1;
};

// --profile, --link and --seed. `options` outlives the parsing.
void add_network_options(CLI::App& app, NetworkOptions& options);

// `length_s`: s; 0: the default length.
SelftestSettings selftest_settings(const NetworkOptions& options, double length_s);
// The exit code: 1 if the verdict is FAIL.
int run_and_print(const SelftestSettings& settings, SelftestPath& path, bool json);

// Prints the notes of tc's words. Throws Error (usage; data for a file that a profile names).
Network read_network(const NetworkOptions& options);

}  // namespace thimble
