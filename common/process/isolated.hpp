// Work in a copy of this process, for foreign code that may crash, hang or write where it should not: a plug-in costs its own trial only.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "common/time.hpp"

namespace thimble {

struct IsolatedResult {
    std::optional<std::string> bytes;  // of the work's result; none: it failed
    std::string failure;               // why, and what the copy said last
};

// Runs `work` in a child made by fork, and kills it after `limit` of the wall clock. All other changes that `work`
// makes are lost with the child. An Error that it throws is a failure with the Error's text. Several threads may call
// this at once.
IsolatedResult run_isolated(const std::function<std::string()>& work,
                            Duration limit = std::chrono::seconds{60});

// For results of plain numbers, which both copies of the program lay out alike.
template <class Plain>
std::string bytes_of(const Plain& value) {
    static_assert(std::is_trivially_copyable_v<Plain>);
    return {reinterpret_cast<const char*>(&value), sizeof value};
}
// Takes the value from the front of `bytes`, which has it.
template <class Plain>
Plain take_plain(std::string_view& bytes) {
    static_assert(std::is_trivially_copyable_v<Plain>);
    Plain value{};
    bytes.copy(reinterpret_cast<char*>(&value), sizeof value);
    bytes.remove_prefix(sizeof value);
    return value;
}

}  // namespace thimble
