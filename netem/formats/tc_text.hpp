// Link settings in tc-netem's own words (grammar: man tc-netem of iproute2 6.1; units: man tc), both ways.
//   delay 50ms 10ms 25% distribution normal loss 0.5% duplicate 1% corrupt 0.1% reorder 25% gap 5 rate 1mbit limit 1000
//   slot 800us 10ms packets 42 bytes 64k      loss gemodel 1% 10% 70% 0.1%      loss state 1% 20% 10% 30% 0.1%
// What the words mean here and not in tc stands in docs/network-profiles.md.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "netem/link_settings.hpp"

namespace thimble {

struct TcLink {
    LinkSettings link;
    std::vector<std::string> notes;  // what was left out or means another thing here, a sentence each
};

// Finds the table of `distribution NAME` beyond tc's four; throws Error if there is none.
using TableFinder = std::function<std::shared_ptr<const JitterTable>(std::string_view name)>;

// A whole command, "tc qdisc add dev eth0 root netem ...", may be given as it is. Keywords may be cut as tc allows
// ("dist", "dup"). One word is ours: "unordered" lets packets overtake each other under jitter, as tc always does.
// Throws Error (usage) that names the word and what may stand there.
TcLink parse_tc_words(std::string_view text, const TableFinder& find_table);
TcLink parse_tc_words(std::string_view text);  // tables from files (find_jitter_table)

// Whether `text` is meant as tc's words rather than a name or a path: it has several words, the first one tc's.
bool looks_like_tc_words(std::string_view text);

struct TcCommands {
    std::string words;                // after "netem"
    std::string command;              // to be typed as it is
    std::vector<std::string> cannot;  // what tc does not do, or otherwise, a sentence each
};

// parse_tc_words(print_tc(x).words) is x for all that tc can express: jitter other than gamma, corruption of one
// bit, order kept unless `reorder` is asked for, no outages, traces, limits of the rate's own queue.
TcCommands print_tc(const LinkSettings& link, std::string_view device);

}  // namespace thimble
