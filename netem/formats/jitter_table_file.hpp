// iproute2's .dist files: whole numbers in rising order, 8192 to a standard deviation, lines of '#' are comments.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "netem/jitter_table.hpp"

namespace thimble {

inline constexpr double kDistScale = 8192;             // of one spread (NETEM_DIST_SCALE)
inline constexpr std::size_t kMostDistValues = 16384;  // as tc takes; its own tables have 4096

// Throws Error (data) with file and line for what is no table: fewer than two values, a value outside of
// -32768 to 32767. Values in any order are sorted, since tc draws them at random.
JitterTable parse_jitter_table(std::string_view text, std::string_view name);

// A path, or the name of a table in tc's folders (TC_LIB_DIR, then where distributions install it).
std::shared_ptr<const JitterTable> find_jitter_table(std::string_view name);

// `values` of them, at the middle of equal shares, as tc's own tables are made. Values beyond 4 spreads are cut, because a value has 16 bits.
std::string print_jitter_table(const JitterTable& table, std::string_view comment, std::size_t values = 4096);

}  // namespace thimble
