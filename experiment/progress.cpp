#include "experiment/progress.hpp"

#include <cstdio>
#include <unistd.h>

namespace thimble {

Progress::Progress() : terminal_(isatty(STDERR_FILENO) != 0) {}

void Progress::show(const std::string& line, bool milestone) {
    if (terminal_) {
        std::fprintf(stderr, "\r\033[K%s", line.c_str());
        std::fflush(stderr);
        open_ = true;
    } else if (milestone) {
        std::fprintf(stderr, "%s\n", line.c_str());
    }
}

void Progress::say(const std::string& line) {
    if (open_) std::fputs("\r\033[K", stderr);
    open_ = false;
    std::fprintf(stderr, "%s\n", line.c_str());
}

}  // namespace thimble
