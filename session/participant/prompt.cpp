#include "session/participant/prompt.hpp"

#include "session/participant/tsv.hpp"

namespace thimble {

PromptCommand parse_prompt_line(std::string_view line) {
    const std::string words = tsv_text(line);
    if (words == kNotAvailable) return {PromptKind::kGoOn, {}};
    if (words == "q") return {PromptKind::kQuit, {}};
    const bool reject = words == "r" || words.starts_with("r ");
    if (!reject && words != "x" && !words.starts_with("x ")) return {PromptKind::kUnknown, {}};
    const std::string reason = tsv_text(std::string_view(words).substr(1));
    if (reason == kNotAvailable) return {PromptKind::kNoReason, {}};
    return {reject ? PromptKind::kReject : PromptKind::kExclude, reason};
}

}  // namespace thimble
