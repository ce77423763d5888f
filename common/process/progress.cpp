#include "common/process/progress.hpp"

#include <unistd.h>

#include "common/runtime/standard_streams.hpp"

namespace thimble {
namespace {

constexpr const char* kOverTheLine = "\r\033[K";
constexpr Duration kBeforeResults = std::chrono::milliseconds{500};

}  // namespace

Progress::Progress() : terminal_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() { stderr_written_within(kBeforeResults); }

void Progress::show(const std::string& line, bool milestone) {
    if (terminal_) {
        write_stderr(kOverTheLine + line);
        open_ = true;
    } else if (milestone) {
        write_stderr(line + "\n");
    }
}

void Progress::say(const std::string& line) {
    write_stderr((open_ ? kOverTheLine : "") + line + "\n");
    open_ = false;
}

}  // namespace thimble
