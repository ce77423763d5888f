#include "common/runtime/standard_streams.hpp"

#include <cerrno>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <memory>
#include <mutex>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <string>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>
#include <spdlog/details/os.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

namespace thimble {

namespace {

constexpr std::size_t kMostWaiting = 1U << 16U;  // bytes

// May wait for ever; what the descriptor refuses is lost.
void write_all(std::string_view words) {
    while (!words.empty()) {
        const ssize_t n = ::write(STDERR_FILENO, words.data(), words.size());
        if (n >= 0) {
            words.remove_prefix(static_cast<std::size_t>(n));
        } else if (errno == EAGAIN) {
            pollfd room{STDERR_FILENO, POLLOUT, 0};
            ::poll(&room, 1, -1);
        } else if (errno != EINTR) {
            return;
        }
    }
}

class StderrQueue {
  public:
    StderrQueue() {
        waiting_.reserve(kMostWaiting);
        writing_.reserve(kMostWaiting);
    }

    void add(std::string_view words) {
        const std::lock_guard lock(mutex_);
        if (!waiting_.empty() && waiting_.size() + words.size() > kMostWaiting) {
            ++dropped_;
            return;
        }
        waiting_ += words;
        if (!started_) start();
        changed_.notify_all();
    }

    bool empty_within(Duration limit) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, limit, [this] { return waiting_.empty() && !busy_; });
    }

  private:
    // No signal is this thread's: their handlers interrupt the loops that they are for.
    void start() {
        sigset_t all, before;
        sigfillset(&all);
        pthread_sigmask(SIG_SETMASK, &all, &before);
        try {
            std::thread([this] { write(); }).detach();
            started_ = true;
        } catch (const std::system_error&) {
            write_all(waiting_);  // the system has no more threads
            waiting_.clear();
        }
        pthread_sigmask(SIG_SETMASK, &before, nullptr);
    }

    [[noreturn]] void write() {
        const sched_param none{};
        sched_setscheduler(0, SCHED_OTHER, &none);  // whatever the loop has that spoke first
        std::unique_lock lock(mutex_);
        for (;;) {
            changed_.wait(lock, [this] { return !waiting_.empty(); });
            std::swap(waiting_, writing_);
            const std::size_t dropped = std::exchange(dropped_, 0);
            busy_ = true;
            lock.unlock();
            write_all(writing_);
            if (dropped > 0)
                write_all(
                    fmt::format("\n"
                                "[{} messages are missing here, because the terminal was too slow]\n",
                                dropped));
            writing_.clear();
            lock.lock();
            busy_ = false;
            changed_.notify_all();
        }
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::string waiting_, writing_;
    std::size_t dropped_ = 0;  // behind the last of those that wait
    bool started_ = false, busy_ = false;
};

// Never destroyed: its thread may hang in a write until the program has ended. A forked child has no such thread, and begins anew.
StderrQueue*& stderr_queue() {
    static StderrQueue* queue = [] {
        pthread_atfork(nullptr, nullptr, [] { stderr_queue() = new StderrQueue; });
        return new StderrQueue;
    }();
    return queue;
}

class WordsSink final : public spdlog::sinks::base_sink<std::mutex> {
  protected:
    void sink_it_(const spdlog::details::log_msg& message) override {
        spdlog::memory_buf_t formatted;
        formatter_->format(message, formatted);
        const std::string_view line(formatted.data(), formatted.size());
        if (!coloured_ || message.color_range_end <= message.color_range_start) return write_stderr(line);
        const std::size_t begin = message.color_range_start, end = message.color_range_end;
        write_stderr(fmt::format("{}{}{}\033[m{}", line.substr(0, begin), colour(message.level),
                                 line.substr(begin, end - begin), line.substr(end)));
    }
    void flush_() override {}

  private:
    static const char* colour(spdlog::level::level_enum level) {
        if (level >= spdlog::level::err) return "\033[1;31m";
        return level == spdlog::level::warn ? "\033[1;33m" : "\033[32m";
    }

    bool coloured_ = spdlog::details::os::in_terminal(stderr) && spdlog::details::os::is_color_terminal();
};

}  // namespace

void open_standard_descriptors() {
    for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
        // The lowest number that is free is this one: those below it are open.
        static_cast<void>(open("/dev/null", descriptor == STDIN_FILENO ? O_RDONLY : O_WRONLY));
    }
}

void write_stderr(std::string_view words) { stderr_queue()->add(words); }

bool stderr_written_within(Duration limit) { return stderr_queue()->empty_within(limit); }

void log_to_stderr(const std::string& program) {
    stderr_queue();  // before there are threads: a child that is forked while one makes it waits for ever
    spdlog::set_default_logger(std::make_shared<spdlog::logger>(program, std::make_shared<WordsSink>()));
    spdlog::set_pattern("%n: %^%l%$: %v");
}

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
            "standard output cannot be written{}, so results are lost; free space on its disk or redirect "
            "it, and run the command again",
            reason);
    }
    return exit_code == 0 ? static_cast<int>(ExitCode::kRunFailed) : exit_code;
}

}  // namespace thimble
