#pragma once

#include <string_view>

namespace thimble {

// Cuts `text` behind the next `end` and returns what stood before it; all of it where there is none.
inline std::string_view take_until(std::string_view& text, char end) {
    const std::size_t at = text.find(end);
    const std::string_view part = text.substr(0, at);
    text.remove_prefix(at == std::string_view::npos ? text.size() : at + 1);
    return part;
}

}  // namespace thimble
