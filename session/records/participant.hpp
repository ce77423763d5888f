// The participant of a session: a number and nothing else, "P07" on the command line, sub-07 in the data. Any other
// name is refused, so that no person's name gets into the data.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "common/decimal_text.hpp"

namespace thimble {

enum class SubjectKind : std::uint8_t { kVirtual, kHuman };
// "virtual", "human"
inline const char* to_string(SubjectKind kind) { return kind == SubjectKind::kHuman ? "human" : "virtual"; }
inline std::optional<SubjectKind> parse_subject_kind(std::string_view text) {
    for (const SubjectKind kind : {SubjectKind::kVirtual, SubjectKind::kHuman}) {
        if (text == to_string(kind)) return kind;
    }
    return std::nullopt;
}

// "P07", "P7" and "sub-07" are 7; from 1 to 1 000 000. Nothing for any other text.
inline std::optional<std::uint32_t> parse_participant(std::string_view text) {
    for (const std::string_view prefix : {"P", "sub-"}) {
        if (!text.starts_with(prefix)) continue;
        const auto number = parse_whole<std::int64_t>(text.substr(prefix.size()));
        if (number && *number >= 1 && *number <= 1'000'000) return static_cast<std::uint32_t>(*number);
    }
    return std::nullopt;
}

// "sub-07", as BIDS calls it
inline std::string participant_id(std::uint32_t participant) { return fmt::format("sub-{:02}", participant); }

}  // namespace thimble
