#include "common/process/isolated.hpp"

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <mutex>
#include <optional>
#include <poll.h>
#include <string_view>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include "common/codec.hpp"
#include "common/control/built_in_controllers.hpp"
#include "common/error.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/text_file.hpp"

namespace thimble {
#ifdef __EMSCRIPTEN__
// A browser has no processes.
IsolatedResult run_isolated(const std::function<std::string()>& work, Duration /*limit*/) {
    return {work(), {}};
}
#else
namespace {

constexpr char kGood = 'g', kBad = 'b';
constexpr Duration kLastWords = std::chrono::milliseconds{300};

std::string answer_of(const std::function<std::string()>& work) {
    try {
        return kGood + work();
    } catch (const std::exception& error) {
        return fmt::format("{}{}", kBad, error.what());
    }
}

// No destructor and no handler of the parent runs here.
[[noreturn]] void be_the_child(const std::function<std::string()>& work, int answer, int words) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    setpgid(0, 0);  // with all that it starts
    if (words >= 0) dup2(words, STDERR_FILENO);
    // A foreign exit() within `work` gives no answer.
    const std::string bytes = answer_of(work);
    _exit(write_all(answer, bytes_of(bytes.size()) + bytes) ? 0 : 1);
}

// The answer begins with its length: another thread's child may hold the pipe open.
bool is_whole(std::string_view bytes) {
    const std::size_t size = bytes.size();  // before take_plain() shortens them
    return size >= sizeof(std::size_t) && size - sizeof(std::size_t) >= take_plain<std::size_t>(bytes);
}

// A child of fork would wait for ever for a static that another thread was making.
void make_statics() {
    const Encoder encoder;
    for (std::size_t i = 0; i < kBuiltInCompensators.size(); ++i) {
        ControlSettings control;
        control.compensator = static_cast<Compensator>(i);
        controller_of(control);
    }
}

// Until the answer is whole or the pipe ends, or the time limit: false.
bool read_until(int from, SessionTime end, std::string& bytes) {
    for (std::array<char, 65536> block{}; !is_whole(bytes);) {
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - wall_now());
        if (left.count() <= 0) return false;
        pollfd ready{from, POLLIN, 0};
        if (poll(&ready, 1, static_cast<int>(std::min<std::int64_t>(left.count(), 1000))) <= 0) continue;
        const ssize_t got = read(from, block.data(), block.size());
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return true;
        bytes.append(block.data(), static_cast<std::size_t>(got));
    }
    return true;
}

// The last one, or the one about a plug-in: a sanitizer's report may follow that.
std::string last_line(int words) {
    std::array<char, 16384> end{};
    const off_t size = lseek(words, 0, SEEK_END);
    const ssize_t got = pread(words, end.data(), end.size(), std::max<off_t>(0, size - off_t{end.size()}));
    std::string_view text(end.data(), got > 0 ? static_cast<std::size_t>(got) : 0);
    if (const std::size_t at = text.rfind("plug-in "); at != std::string_view::npos) {
        text.remove_prefix(at);
        return std::string(take_until(text, '\n'));
    }
    while (!text.empty() && text.back() == '\n') text.remove_suffix(1);
    return std::string(text.substr(text.rfind('\n') + 1));
}

std::string end_text(int status) {
    if (WIFSIGNALED(status))
        return fmt::format("signal {} ({}) ended it", WTERMSIG(status), strsignal(WTERMSIG(status)));
    return fmt::format("it ended the program with exit code {}", WEXITSTATUS(status));
}

// Ends what the child started as well. Until it is waited for, its number is its group's.
int wait_for(pid_t child) {
    siginfo_t ended{};
    while (waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT) < 0 && errno == EINTR) {
    }
    kill(-child, SIGKILL);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
}

}  // namespace

IsolatedResult run_isolated(const std::function<std::string()>& work, Duration limit) {
    static std::mutex forks;
    std::unique_lock alone(forks);  // or another thread's child would keep this pipe's end
    static const bool ready = (make_statics(), true);
    static_cast<void>(ready);
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw Error(ExitCode::kRunFailed, "no pipe for a child process");
    const FileDescriptor answer(ends[0]), words(memfd_create("words", MFD_CLOEXEC));
    std::optional<FileDescriptor> to_parent(std::in_place, ends[1]);
    std::fflush(nullptr);  // or the child would write it as well
    const pid_t child = fork();
    if (child < 0) throw Error(ExitCode::kRunFailed, "no child process: {}", std::strerror(errno));
    if (child == 0) {
        alone.unlock();
        be_the_child(work, to_parent->get(), words.get());
    }
    to_parent.reset();
    alone.unlock();
    std::string bytes;
    const bool ended = read_until(answer.get(), wall_now() + limit, bytes);
    if (!ended) {
        kill(child, SIGXCPU);  // a plug-in's name is said then (common/control/controller_calls.cpp)
        read_until(answer.get(), wall_now() + kLastWords, bytes);
        kill(child, SIGKILL);
    }
    const int status = wait_for(child);
    if (ended && is_whole(bytes)) {
        const std::string_view given = std::string_view(bytes).substr(sizeof(std::size_t));
        if (given.front() == kBad) return {std::nullopt, std::string(given.substr(1))};
        if (status == 0) return {std::string(given.substr(1)), {}};
    }
    const std::string said = last_line(words.get());
    const std::string how =
        ended ? end_text(status) : fmt::format("it took longer than {} s", to_seconds(limit));
    return {std::nullopt, said.empty() ? how : fmt::format("{}; {}", said, how)};
}
#endif

}  // namespace thimble
