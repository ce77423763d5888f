// The experimenter's commands between two trials.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/time.hpp"

namespace thimble {

enum class PromptKind : std::uint8_t {
    kGoOn,     // an empty line
    kReject,   // r WHY: the last trial is run again
    kExclude,  // x WHY: the last trial is left out of the analysis and not repeated
    kQuit,     // q
    kNoReason,
    kUnknown,
};

struct PromptCommand {
    PromptKind kind = PromptKind::kUnknown;
    std::string reason;
};

inline constexpr const char* kPromptHelp =
    "Enter: go on; r WHY: run the last trial again; x WHY: leave the last trial out; q: stop here";

PromptCommand parse_prompt_line(std::string_view line);

// A rest. It ends after its minimum and, where an experimenter answers, with Enter.
class Rest {
  public:
    Rest(SessionTime begin, Duration minimum, bool asks) : end_(begin + minimum), asks_(asks) {}
    Duration left(SessionTime now) const { return now < end_ ? end_ - now : Duration{0}; }
    bool over_by_itself(SessionTime now) const { return !asks_ && now >= end_; }
    bool over_by_enter(SessionTime now) const { return asks_ && now >= end_; }

  private:
    SessionTime end_;
    bool asks_;
};

}  // namespace thimble
