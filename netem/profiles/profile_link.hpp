// One direction of a profile: a table of keys, read and written. A key that is absent leaves what `base` says.
//   delay_s = 0.035            mean, 0 to 60
//   jitter = "pareto-normal"   "none", "uniform", "normal", "gamma", "pareto", "pareto-normal", "table"
//   jitter_spread_s = 0.008    half width (uniform) or standard deviation
//   jitter_correlation = 0.5   from packet to packet, 0 to below 1
//   jitter_table = "my.dist"   for jitter = "table"
//   loss = 0.001               share lost in the long run, 0 to 1
//   loss_burst = 4             packets lost in a row in the mean: a Gilbert model; 0: each on its own
//   rate_bits_per_s = 12e6     0: no limit
//   rate_overhead_bytes, rate_queue_packets, rate_queue_bytes, rate_drop = "tail" or "head"
//   slot_least_s, slot_most_s, slot_packets, slot_bytes
//   duplicate, corrupt, corrupt_bits, reorder, reorder_gap, in_order, capacity
//   trace = "leo.csv"          with trace_by = "time" or "packet", trace_between = "hold" or "linear",
//                              trace_end = "wrap" or "hold"
//   deliveries = "cell.pdo"    a mahimahi trace
//   [[up.outage]]              start_s, length_s, every_s (0: once)
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "common/config.hpp"
#include "netem/link_settings.hpp"

namespace thimble {

// The text of a file that a profile names, from beside it or out of the program.
using FileFinder = std::function<std::string(std::string_view name)>;

// Throws Error (usage) with file, line and key; Error (data) for what is wrong in a file that is named.
LinkSettings read_profile_link(const ConfigTable& table, const LinkSettings& base, const FileFinder& find);

// As the keys above, one line each, without those at their defaults. Files of tables and traces are not written: a
// link that has them gets a comment instead.
std::string print_profile_link(const LinkSettings& link);

}  // namespace thimble
