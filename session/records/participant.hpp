// Whom a participant session is with. A participant is a number and nothing else: "P07" on the command line, sub-07 in
// the data. Any other name is refused, so that no person's name gets into the data.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace thimble {

enum class SubjectKind : std::uint8_t { kVirtual, kHuman };
const char* to_string(SubjectKind kind);  // "virtual", "human"
std::optional<SubjectKind> parse_subject_kind(std::string_view text);

// "P07", "P7" and "sub-07" are 7; from 1 to 1 000 000. Nothing for any other text.
std::optional<std::uint32_t> parse_participant(std::string_view text);
std::string participant_id(std::uint32_t participant);  // "sub-07", as BIDS calls it

}  // namespace thimble
