#include "session/launch/remote_shell.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <iterator>
#include <sstream>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "common/error.hpp"

namespace thimble {
namespace {

// Limits of report and log, which usually have a few kilobytes.
constexpr std::size_t kMostSaid = std::size_t{1} << 20, kMostLogged = std::size_t{1} << 22;
// Output after the file: a shell may print a farewell.
constexpr std::size_t kFarewell = std::size_t{1} << 12;
// Chunks per poll: more than a pipe holds, so that no output of an ended command is left. Few enough to return
// quickly.
constexpr int kMostChunks = 16;

// Of the files of all shells of this program: announced (of one that was cut off, what came), and written.
std::atomic<std::uint64_t> all_announced{0}, all_in_files{0};

std::ofstream open_log(const std::filesystem::path& path) {
    std::ofstream file(path, std::ios::binary | std::ios::app);
    if (file) return file;
    throw Error(ExitCode::kRunFailed, "cannot write the log {}: {}; check its folder, or name another",
                path.string(), std::strerror(errno));
}

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
    std::array<int, 6> ends{-1, -1, -1, -1, -1, -1};
    int &command_reads = ends[0], &we_write = ends[1], &we_read = ends[2], &command_writes = ends[3],
        &we_read_errors = ends[4], &command_complains = ends[5];

    // Other children must not inherit the ends that are kept: a shell would not see the end of its input.
    Pipes() {
        for (int* pair = ends.data(); pair != ends.data() + ends.size(); pair += 2) {
            if (pipe2(pair, O_CLOEXEC) == 0) continue;
            const std::string why = std::strerror(errno);
            close_all();
            throw Error(ExitCode::kRunFailed, "cannot make a pipe: {}; raise 'ulimit -n'", why);
        }
        for (const int ours : {we_write, we_read, we_read_errors}) fcntl(ours, F_SETFL, O_NONBLOCK);
    }
    ~Pipes() { close_all(); }
    void close_all() const {
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
    : child_(start(command, log, {pipes.command_reads, pipes.command_writes, pipes.command_complains})),
      input_(std::exchange(pipes.we_write, -1)),
      output_(std::exchange(pipes.we_read, -1)),
      error_(std::exchange(pipes.we_read_errors, -1)),
      log_(open_log(log)) {}

RemoteShell::~RemoteShell() {
    hang_up();
    close(output_);
    close(error_);
    all_announced -= counted_ - std::min(counted_, in_file_);  // the rest does not come any more
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

template <class Use>
void RemoteShell::hear(int from, Use&& use) {
    std::array<char, 65536> chunk{};
    for (int chunks = 0; chunks < kMostChunks; ++chunks) {
        const ssize_t n = read(from, chunk.data(), chunk.size());
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return;
        use(std::string_view(chunk.data(), static_cast<std::size_t>(n)));
    }
}

void RemoteShell::take(std::string_view bytes) {
    heard_ += bytes.size();
    if (diverted_) return keep(bytes);
    said_ += bytes.substr(0, kMostSaid - std::min(kMostSaid, said_.size()));
    if (!turn_.empty()) look_for_turn();
    if (!diverted_ && said_.size() >= kMostSaid) fault_ = fmt::format("sends more than {} bytes", kMostSaid);
}

// Its standard error. The launcher reads and drops the bytes beyond the limit.
void RemoteShell::keep_words(std::string_view bytes) {
    if (logged_ >= kMostLogged) return;
    log_ << bytes.substr(0, kMostLogged - logged_);
    logged_ += bytes.size();
    if (logged_ >= kMostLogged) log_ << fmt::format("\n[more than {} bytes: dropped]\n", kMostLogged);
    log_.flush();
}

void RemoteShell::look_for_turn() {
    const std::size_t at = said_.starts_with(turn_) ? 0 : said_.find('\n' + turn_);
    if (at == std::string::npos) return;
    const std::size_t word = said_.find(turn_, at), end = said_.find('\n', word);
    if (end == std::string::npos) return;
    std::istringstream line(said_.substr(word + turn_.size(), end - word - turn_.size()));
    diverted_.emplace(std::istream_iterator<std::uint64_t>(line), std::istream_iterator<std::uint64_t>{});
    turn_.clear();
    expect_files(*diverted_);
    keep(std::string_view(said_).substr(end + 1));
    said_.resize(word);
}

void RemoteShell::expect_files(const Numbers& numbers) {
    if (!numbers.empty()) announced_ = numbers.back();
    files_ = files_of_(numbers);
    if (files_.empty()) return;
    const std::filesystem::path& first = files_.front().first;
    std::error_code unknown;
    const auto room = std::filesystem::space(first.parent_path(), unknown);
    if (unknown) return;
    // Half of the room before the first of all files, so that results have room, too.
    const std::uint64_t others = all_announced;
    const std::uint64_t most = room.available / 2 + all_in_files / 2;
    if (others <= most && announced_ <= most - others) {
        all_announced += counted_ = announced_;
        return;
    }
    fault_ = fmt::format(
        "announces {} bytes for {}; with the {} bytes of other files this is more than half of the free "
        "space, {} bytes",
        announced_, first.string(), others, 2 * most);
}

// No file for nothing. in_file() lacks bytes that could not be written.
void RemoteShell::keep(std::string_view bytes) {
    if (!fault_.empty()) return;
    std::string_view part = bytes.substr(0, announced_ - std::min(announced_, came_));
    came_ += bytes.size();
    if (came_ > announced_ + kFarewell)
        fault_ = fmt::format("sends more than the {} bytes that it announced", announced_);
    while (!part.empty() && at_ < files_.size()) {
        auto& [name, lacks] = files_[at_];
        const std::string_view of_it = part.substr(0, lacks);
        if (!of_it.empty() && !file_.is_open()) file_.open(name, std::ios::binary | std::ios::trunc);
        if (file_.write(of_it.data(), static_cast<std::streamsize>(of_it.size())).flush()) {
            in_file_ += of_it.size();
            all_in_files += of_it.size();
        }
        part.remove_prefix(of_it.size());
        lacks -= of_it.size();
        if (lacks > 0) return;
        file_ = {};
        ++at_;
    }
}

void RemoteShell::divert_after(std::string_view word, std::function<Files(const Numbers&)> files_of) {
    turn_ = word;
    files_of_ = std::move(files_of);
}

std::optional<int> RemoteShell::poll() {
    feed();
    const auto code = child_.poll();
    // After the check for its end: the pipes then hold all of its output.
    hear(output_, [this](std::string_view bytes) { take(bytes); });
    hear(error_, [this](std::string_view bytes) { keep_words(bytes); });
    if (code || fault_.empty()) return code;
    kill();
    return child_.poll();
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
