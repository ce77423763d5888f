// "Did you mean ...?": the name that the user probably meant.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace thimble {

// Returns the name with the smallest edit distance to `typed` (insertion, deletion, substitution, swap of
// neighbours). Case and unit suffixes do not count: "delay_ms" matches "delay_s". Else the shortest name with `typed`
// among its words: "position" matches "position_scale". Empty beyond a third of the letters (one edit is always
// allowed).
std::string nearest_name(std::string_view typed, const std::vector<std::string>& names);

}  // namespace thimble
