// JSON as text, the only place that writes it.
#pragma once

#include <string>

namespace thimble {

// A path or a name may hold bytes that are no UTF-8. They become U+FFFD; dump() alone would throw.
template <class Json>
std::string json_text(const Json& json, int indent = -1) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace thimble
