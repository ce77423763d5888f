#include "session/records/participant.hpp"

#include <fmt/format.h>

#include "netem/formats/text_lines.hpp"

namespace thimble {

const char* to_string(SubjectKind kind) { return kind == SubjectKind::kHuman ? "human" : "virtual"; }

std::optional<SubjectKind> parse_subject_kind(std::string_view text) {
    for (const SubjectKind kind : {SubjectKind::kVirtual, SubjectKind::kHuman}) {
        if (text == to_string(kind)) return kind;
    }
    return std::nullopt;
}

std::optional<std::uint32_t> parse_participant(std::string_view text) {
    for (const std::string_view prefix : {"P", "sub-"}) {
        if (!text.starts_with(prefix)) continue;
        const auto number = parse_integer(text.substr(prefix.size()));
        if (number && *number >= 1 && *number <= 1'000'000) return static_cast<std::uint32_t>(*number);
    }
    return std::nullopt;
}

std::string participant_id(std::uint32_t participant) { return fmt::format("sub-{:02}", participant); }

}  // namespace thimble
