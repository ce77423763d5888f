// The language of the control socket. A request is one packet of text: a verb in the first line, then one assignment
// per line:
//   show
//   set
//   up.delay_s = 0.1
//   loss = 0.01
// A key is one of a link (profiles.hpp), a dot between a table and its key; `up.` or `down.` before it names one
// direction, otherwise it is for both. The value is written as in TOML; a bare word stands for itself in quotes.
// The answer is one packet of JSON. Its "ok" is true, or false with an "error" in words.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "netem/relay/relay_settings.hpp"

namespace thimble {

inline constexpr std::size_t kLongestRequestBytes = 16384;

struct ControlRequest {
    enum class Verb { kShow, kSet } verb = Verb::kShow;
    std::vector<std::string> assignments;
};

// Throws Error (usage) that says what is wrong and what is allowed.
ControlRequest parse_request(std::string_view text);

// `base` with the assignments carried out. Throws Error (usage): no such key, a value out of range, a contradiction.
LinkPair assign(const LinkPair& base, const std::vector<std::string>& assignments);

}  // namespace thimble
