#include "common/process/progress.hpp"

#include <unistd.h>

#include "common/runtime/standard_streams.hpp"

namespace thimble {
namespace {

constexpr const char* kOverTheLine = "\r\033[K";
constexpr Duration kBeforeResults = std::chrono::milliseconds{500};

}  // namespace

Progress::Progress() : terminal_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() { words_written_within(kBeforeResults); }

void Progress::show(const std::string& line, bool milestone) {
    if (terminal_) {
        say_words(kOverTheLine + line);
        open_ = true;
    } else if (milestone) {
        say_words(line + "\n");
    }
}

void Progress::say(const std::string& line) {
    say_words((open_ ? kOverTheLine : "") + line + "\n");
    open_ = false;
}

}  // namespace thimble
