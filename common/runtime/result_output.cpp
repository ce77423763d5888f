#include "common/runtime/result_output.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <poll.h>
#include <string>
#include <unistd.h>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace thimble {
namespace {

bool reader_has_left() {
    pollfd output{STDOUT_FILENO, 0, 0};
    return poll(&output, 1, 0) == 1 && (output.revents & POLLERR) != 0;
}

}  // namespace

void flush_results() {
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) throw ResultsLost();
}

int settle_results(int exit_code) {
    errno = 0;
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return exit_code;
    // stdio remembers that an earlier print failed, but not why.
    const std::string reason = errno != 0 ? fmt::format(": {}", std::strerror(errno)) : std::string();
    if (!reader_has_left()) {
        spdlog::error(
            "results are lost: standard output cannot be written{}; free space on its disk or redirect it, "
            "and run the command again",
            reason);
    }
    return exit_code == 0 ? static_cast<int>(ExitCode::kRunFailed) : exit_code;
}

}  // namespace thimble
