// JSON as text, the only place that writes it, and values that may be missing.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace thimble {

// A path or a name may hold bytes that are no UTF-8. They become U+FFFD; dump() alone would throw.
template <class Json>
std::string json_text(const Json& json, int indent = -1) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

// No value becomes null.
template <class Value, class Json = nlohmann::ordered_json>
Json or_null(const std::optional<Value>& value) {
    return value ? Json(*value) : Json();
}

}  // namespace thimble
