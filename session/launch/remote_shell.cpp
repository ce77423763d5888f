#include "session/launch/remote_shell.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "common/error.hpp"

namespace thimble {
namespace {

// A report is a few kilobytes; what says more is no report.
constexpr std::size_t kMostSaid = std::size_t{1} << 24;

Child start(const std::vector<std::string>& command, const std::filesystem::path& log,
            const ChildStreams& streams) {
    try {
        return {command.front(), {command.begin() + 1, command.end()}, log, streams};
    } catch (const Error& error) {
        throw Error(error.code(),
                    fmt::format("{} (it is the first word of [launch].exec, or of --exec)", error.what()));
    }
}

}  // namespace

struct RemoteShell::Pipes {
    std::array<int, 4> ends{-1, -1, -1, -1};
    int &command_reads = ends[0], &we_write = ends[1], &we_read = ends[2], &command_writes = ends[3];

    // Other children must not inherit the ends that are kept: a shell would not see the end of its input.
    Pipes() {
        if (pipe2(ends.data(), O_CLOEXEC) != 0 || pipe2(ends.data() + 2, O_CLOEXEC) != 0) {
            throw Error(ExitCode::kRunFailed, "cannot make a pipe: {}", std::strerror(errno));
        }
        fcntl(we_write, F_SETFL, O_NONBLOCK);
        fcntl(we_read, F_SETFL, O_NONBLOCK);
    }
    ~Pipes() {
        for (const int end : ends) {
            if (end >= 0) close(end);
        }
    }
    Pipes(const Pipes&) = delete;
    Pipes& operator=(const Pipes&) = delete;
};

RemoteShell::RemoteShell(const std::vector<std::string>& command, const std::filesystem::path& log)
    : RemoteShell(command, log, Pipes{}) {}

RemoteShell::RemoteShell(const std::vector<std::string>& command, const std::filesystem::path& log,
                         Pipes&& pipes)
    : child_(start(command, log, {pipes.command_reads, pipes.command_writes})),
      input_(std::exchange(pipes.we_write, -1)),
      output_(std::exchange(pipes.we_read, -1)) {}

RemoteShell::~RemoteShell() {
    hang_up();
    close(output_);
}

void RemoteShell::hang_up() {
    if (input_ >= 0) close(std::exchange(input_, -1));
    pending_.clear();
}

void RemoteShell::feed() {
    while (input_ >= 0 && !pending_.empty()) {
        const ssize_t n = write(input_, pending_.data(), pending_.size());
        if (n > 0) {
            pending_.erase(0, static_cast<std::size_t>(n));
        } else if (errno != EINTR) {
            if (errno != EAGAIN) hang_up();  // its reader has ended: poll() gives the reason
            return;
        }
    }
}

void RemoteShell::hear() {
    std::array<char, 65536> chunk{};
    for (;;) {
        const ssize_t n = read(output_, chunk.data(), chunk.size());
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return;
        take({chunk.data(), static_cast<std::size_t>(n)});
    }
}

void RemoteShell::take(std::string_view bytes) {
    heard_ += bytes.size();
    if (diverted_) return keep(bytes);
    if (said_.size() < kMostSaid) said_ += bytes;
    if (!turn_.empty()) look_for_turn();
}

void RemoteShell::look_for_turn() {
    const std::size_t at = said_.starts_with(turn_) ? 0 : said_.find('\n' + turn_);
    if (at == std::string::npos) return;
    const std::size_t word = said_.find(turn_, at), end = said_.find('\n', word);
    if (end == std::string::npos) return;
    diverted_ = said_.substr(word + turn_.size(), end - word - turn_.size());
    turn_.clear();
    keep(std::string_view(said_).substr(end + 1));
    said_.resize(word);
}

// No file for nothing. in_file() lacks bytes that could not be written.
void RemoteShell::keep(std::string_view bytes) {
    if (bytes.empty() || file_name_.empty()) return;
    if (!file_.is_open()) file_.open(file_name_, std::ios::binary | std::ios::trunc);
    if (file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size())).flush())
        in_file_ += bytes.size();
}

void RemoteShell::divert_after(std::string_view word, std::filesystem::path file) {
    turn_ = word;
    file_name_ = std::move(file);
}

std::optional<int> RemoteShell::poll() {
    feed();
    const auto code = child_.poll();
    hear();  // after the look at the child: what it said before its end is in the pipe
    return code;
}

bool RemoteShell::has_said(std::string_view line) const {
    const std::string whole = fmt::format("{}\n", line);
    const std::size_t at = said_.find(whole);
    return at == 0 || (at != std::string::npos && said_[at - 1] == '\n');
}

void RemoteShell::kill() {
    hang_up();
    child_.signal_group(SIGKILL);
    child_.wait(std::chrono::seconds{1});
}

}  // namespace thimble
