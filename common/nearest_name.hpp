// "Did you mean ...?": the name that the user probably meant.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace thimble {

// The one of `names` that the fewest inserted, left out, changed or swapped neighbouring letters make of `typed`; letter case
// counts nothing, nor do units at the end: "delay_ms" is "delay_s". Else the shortest with `typed` among its words, "position" for
// "position_scale". Empty if that takes more than a third of its letters (one is always allowed): then it is another word.
std::string nearest_name(std::string_view typed, const std::vector<std::string>& names);

}  // namespace thimble
