#include "session/participant/prompt.hpp"

#include <array>
#include <cerrno>
#include <poll.h>
#include <unistd.h>
#include <utility>

#include "session/participant/tsv.hpp"

namespace thimble {
namespace {

constexpr std::size_t kLongestTypedLine = 65536;
constexpr int kMostTypedLines = 4096;  // so many empty lines wait in a terminal of Linux

}  // namespace

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

std::optional<std::string> DescriptorLines::take_line() {
    read_what_is_there();
    const std::size_t end = buffer_.find('\n');
    if (end != std::string::npos) {
        std::string line = buffer_.substr(0, end);
        buffer_.erase(0, end + 1);
        return line;
    }
    if (ended_ && !buffer_.empty()) return std::exchange(buffer_, {});
    return std::nullopt;
}

void DescriptorLines::forget_enter() {
    if (::isatty(descriptor_) != 1) return;
    std::string kept;
    for (int i = 0; i < kMostTypedLines; ++i) {
        const auto line = take_line();
        if (!line) break;
        if (parse_prompt_line(*line).kind != PromptKind::kGoOn) kept += *line + '\n';
    }
    buffer_.insert(0, kept);
}

// No further than the end of a line: an input that never pauses would hold the session.
void DescriptorLines::read_what_is_there() {
    pollfd waiting{descriptor_, POLLIN, 0};
    while (!ended_ && buffer_.find('\n') == std::string::npos && ::poll(&waiting, 1, 0) > 0) {
        if (buffer_.size() >= kLongestTypedLine) {  // nobody types that
            buffer_.clear();
            ended_ = true;
            return;
        }
        std::array<char, 1024> chunk{};
        const ssize_t n = ::read(descriptor_, chunk.data(), chunk.size());
        if (n < 0 && (errno == EINTR || errno == EAGAIN)) return;
        if (n <= 0) {
            ended_ = true;
            return;
        }
        buffer_.append(chunk.data(), static_cast<std::size_t>(n));
    }
}

}  // namespace thimble
