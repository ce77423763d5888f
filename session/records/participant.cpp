#include "session/records/participant.hpp"

#include <charconv>

#include <fmt/format.h>

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
        const std::string_view digits = text.substr(prefix.size());
        std::uint32_t number = 0;
        const char* const end = digits.data() + digits.size();
        const auto [rest, error] = std::from_chars(digits.data(), end, number);
        if (error == std::errc{} && rest == end && number >= 1 && number <= 1'000'000) return number;
    }
    return std::nullopt;
}

std::string participant_id(std::uint32_t participant) { return fmt::format("sub-{:02}", participant); }

}  // namespace thimble
