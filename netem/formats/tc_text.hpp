// Link settings in tc-netem's own words (grammar: man tc-netem of iproute2 6.1; units: man tc), both ways.
//   delay 50ms 10ms 25% distribution normal loss 0.5% duplicate 1% corrupt 0.1% reorder 25% gap 5 rate 1mbit limit 1000
//   slot 800us 10ms packets 42 bytes 64k      loss gemodel 1% 10% 70% 0.1%      loss state 1% 20% 10% 30% 0.1%
// Command lines and the output of `tc qdisc show` hold such words, too (tc_command.hpp). docs/network-profiles.md says
// where a word means another thing than in tc.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/time.hpp"
#include "netem/link_settings.hpp"

namespace thimble {

struct TcLink {
    LinkSettings link;
    std::vector<std::string> notes;       // what was left out or means another thing here, a sentence each
    std::optional<std::uint64_t> seed{};  // of the random numbers
    bool both = false;                    // for both ways
};

enum class Way : std::uint8_t { kUp, kDown };

// A qdisc holds for what leaves its device. So words are the way up alone, unless they say `both` or belong to an ifb device,
// which stands for what comes in. Of two devices the first is the way up and the second the way down.
struct TcWays {
    LinkSettings up, down;
    bool one_way = false;  // nothing was said about the way down
    std::vector<std::string> notes;
    std::optional<std::uint64_t> seed{};
};

// Finds the table of `distribution NAME` beyond tc's four; throws Error if there is none.
using TableFinder = std::function<std::shared_ptr<const JitterTable>(std::string_view name)>;

// Keywords may be cut as tc allows ("dist", "dup"). Three words are ours. "ordered" keeps the order of packets under jitter,
// which tc does only with a rate. "unordered" lets them overtake each other then, too. "both" is for both ways.
// `known`: all words are for this way, whatever their device is.
// Throws Error (usage) that names the word and what may stand there.
TcWays parse_tc(std::string_view text, const TableFinder& find_table, std::optional<Way> known = {});
TcWays parse_tc(std::string_view text, std::optional<Way> known = {});  // tables by find_jitter_table()
struct TcQdisc;                                                         // tc_command.hpp
TcLink parse_netem_words(const TcQdisc& qdisc, const TableFinder& find_table);

// Whether `text` is meant as tc's words rather than a name or a path: it has several words, the first one tc's, or names tc.
bool looks_like_tc_words(std::string_view text);

struct TcCommands {
    std::string words;                // after "netem"
    std::string command;              // to be typed as it is
    std::vector<std::string> cannot;  // what tc does not do, or otherwise, a sentence each
};

// parse_tc(print_tc(x).words).up is x for all that tc can express: jitter other than gamma, corruption of one
// bit, order kept unless there is `reorder`, or jitter without a rate; no outages, traces, limits of the rate's own queue.
TcCommands print_tc(const LinkSettings& link, std::string_view device);

// Times, shares, rates and sizes as tc writes and reads them (iproute2, man tc "PARAMETERS"). Both ways are exact:
// what is printed here is read back as the same value.

// "50ms", "0.8s", "100usec", "5ns". A bare number is in units of `bare`: microseconds for delays, nanoseconds for
// slots. Nothing for what is no time, negative, or above an hour.
std::optional<Duration> parse_tc_time(std::string_view word, Duration bare);
// "0.5%" or "0.5": 0.005. Nothing outside of 0 to 100.
std::optional<double> parse_tc_share(std::string_view word);
// Bits per second: "1mbit", "125kbps" (bytes per second), "1mibit", a bare number in bit/s.
std::optional<double> parse_tc_rate(std::string_view word);
// Bytes: "64k" is 65536, "8kbit" 1024, a bare number bytes.
std::optional<std::size_t> parse_tc_size(std::string_view word);

std::string print_tc_time(Duration time);
std::string print_tc_share(double share);
std::string print_tc_rate(double bits_per_s);

}  // namespace thimble
