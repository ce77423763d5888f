#include "experiment/sitting/commands.hpp"

#include "experiment/sitting/tsv.hpp"

namespace thimble {

Command parse_command(std::string_view line) {
    const std::string words = tsv_text(line);
    if (words == kNotAvailable) return {CommandKind::kGoOn, {}};
    if (words == "q") return {CommandKind::kQuit, {}};
    const bool reject = words == "r" || words.starts_with("r ");
    if (!reject && words != "x" && !words.starts_with("x ")) return {CommandKind::kUnknown, {}};
    const std::string reason = tsv_text(std::string_view(words).substr(1));
    if (reason == kNotAvailable) return {CommandKind::kNoReason, {}};
    return {reject ? CommandKind::kReject : CommandKind::kExclude, reason};
}

}  // namespace thimble
