#include "common/process/child.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <deque>
#include <fcntl.h>
#include <iterator>
#include <spawn.h>
#include <sstream>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/text_file.hpp"

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX wants it declared by its user

namespace thimble {
namespace {

// The most of a log that an error message quotes.
constexpr off_t kMostRead = 1 << 16;
constexpr std::size_t kLongestLine = 1000;

std::string end_of(int file) {
    const off_t size = lseek(file, 0, SEEK_END);
    std::string text(static_cast<std::size_t>(kMostRead), '\0');
    const ssize_t n = pread(file, text.data(), text.size(), std::max(off_t{0}, size - kMostRead));
    text.resize(n < 0 ? 0 : static_cast<std::size_t>(n));
    return text;
}

int exit_code_of(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status); }

}  // namespace

Child::Child(const std::filesystem::path& program, const std::vector<std::string>& arguments,
             std::filesystem::path log, ChildStreams streams, const ChildPlace& place)
    : log_(std::move(log)),
      words_(std::make_shared<FileDescriptor>(
          ::open(log_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644))) {
    if (words_->get() < 0) fail_to_create(log_, errno, ExitCode::kRunFailed);
    std::vector<std::string> words{program.string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    direct(files, streams, place);
    // A terminal's Ctrl-C goes to the launcher alone, which then ends the trial in order.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
    // This program ignores SIGPIPE. A child that inherits that would write to closed pipes for ever.
    sigset_t defaults;
    sigemptyset(&defaults);
    sigaddset(&defaults, SIGPIPE);
    posix_spawnattr_setsigdefault(&attributes, &defaults);
    const int error = posix_spawnp(&pid_, program.c_str(), &files, &attributes, argv.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    if (error != 0) {
        throw Error(ExitCode::kRunFailed, "cannot start {}: {}; {}", program.string(), std::strerror(error),
                    place.remedy);
    }
}

Child::Child(Child&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      exit_code_(other.exit_code_),
      log_(std::move(other.log_)),
      words_(std::move(other.words_)) {}

Child::~Child() {
    if (pid_ < 0 || poll()) return;
    signal(SIGTERM);
    if (wait(std::chrono::seconds{1})) return;
    signal(SIGKILL);
    wait(std::chrono::seconds{1});
}

void Child::direct(posix_spawn_file_actions_t& files, const ChildStreams& streams,
                   const ChildPlace& place) const {
    if (streams.input >= 0) {
        posix_spawn_file_actions_adddup2(&files, streams.input, STDIN_FILENO);
    } else {
        posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    }
    posix_spawn_file_actions_adddup2(&files, streams.error >= 0 ? streams.error : words_->get(),
                                     STDERR_FILENO);
    posix_spawn_file_actions_adddup2(&files, streams.output >= 0 ? streams.output : STDERR_FILENO,
                                     STDOUT_FILENO);
    if (!place.directory.empty()) posix_spawn_file_actions_addchdir_np(&files, place.directory.c_str());
}

std::optional<int> Child::poll() {
    int status = 0;
    if (!exit_code_ && waitpid(pid_, &status, WNOHANG) == pid_) {
        exit_code_ = exit_code_of(status);
    }
    return exit_code_;
}

int Child::wait_for_ever() {
    int status = 0;
    while (!exit_code_ && waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    if (!exit_code_) exit_code_ = exit_code_of(status);
    return *exit_code_;
}

void Child::signal(int number) {
    if (!poll()) kill(pid_, number);
}

void Child::signal_group(int number) {
    if (!poll()) kill(-pid_, number);
}

std::optional<int> Child::wait(Duration limit) {
    const SessionTime deadline = wall_now() + limit;
    while (!poll() && wall_now() < deadline) wall_sleep(std::chrono::milliseconds{5});
    return exit_code_;
}

std::string Child::last_lines(std::size_t lines) const {
    std::istringstream file(end_of(words_->get()));
    std::deque<std::string> last;
    for (std::string line; std::getline(file, line);) {
        if (line.size() > kLongestLine) line.replace(kLongestLine, std::string::npos, "...");
        last.push_back(std::move(line));
        if (last.size() > lines) last.pop_front();
    }
    return printable(fmt::format("{}", fmt::join(last, "\n")));
}

// The output goes to an anonymous file in memory, so that no file is left behind.
ProgramResult run_program(const std::string& program, const std::vector<std::string>& arguments,
                          const std::filesystem::path& directory, const std::string& remedy) {
    const FileDescriptor words(::memfd_create("words", MFD_CLOEXEC));
    const std::string path = fmt::format("/proc/{}/fd/{}", ::getpid(), words.get());
    Child child(program, arguments, path, {}, {directory, remedy});
    ProgramResult result;
    result.exit_code = child.wait_for_ever();
    result.output = read_text_file(path);
    return result;
}

}  // namespace thimble
