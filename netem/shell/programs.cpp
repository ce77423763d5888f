#include "netem/shell/programs.hpp"

#include <algorithm>
#include <array>
#include <csignal>
#include <sys/wait.h>
#include <unistd.h>

namespace thimble {
namespace {

constexpr std::array kForwarded{SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGUSR1, SIGUSR2};
constexpr Duration kAfterCtrlC = std::chrono::seconds{1};
constexpr Duration kPatience = std::chrono::seconds{2};

}  // namespace

SignalLine::SignalLine() : descriptor_(-1) {
    sigset_t wanted;
    sigemptyset(&wanted);
    for (const int number : kForwarded) sigaddset(&wanted, number);
    sigaddset(&wanted, SIGCHLD);
    pthread_sigmask(SIG_BLOCK, &wanted, nullptr);
    descriptor_ = signalfd(-1, &wanted, SFD_NONBLOCK | SFD_CLOEXEC);
}

SignalLine::~SignalLine() { close(descriptor_); }

std::optional<signalfd_siginfo> SignalLine::next() {
    signalfd_siginfo signal{};
    if (read(descriptor_, &signal, sizeof signal) != sizeof signal) return std::nullopt;
    return signal;
}

// A terminal has sent its signals to the programs too (si_code SI_KERNEL), unless they have left the process group.
void Programs::obey(const signalfd_siginfo& signal, SessionTime now) {
    const int number = static_cast<int>(signal.ssi_signo);
    if (number == SIGCHLD) return;
    if (signal.ssi_code != SI_KERNEL) signal_all(number);
    const bool ends = number == SIGTERM || number == SIGHUP || (number == SIGINT && rooms_.size() > 1);
    if (!ends) return;
    asked_code_ = 128 + number;
    if (++asked_ > 1) signal_all(SIGKILL);
    if (rooms_.size() > 1) ask_at_ = std::min(ask_at_, now + kAfterCtrlC);
}

void Programs::signal_all(int number) {
    for (std::size_t i = 0; i < rooms_.size(); ++i) {
        if (!codes_[i]) kill(rooms_[i]->pid(), number);
    }
}

void Programs::look(SessionTime now) {
    for (std::size_t i = 0; i < rooms_.size(); ++i) {
        if (codes_[i]) continue;
        int status = 0;
        const pid_t ended = waitpid(rooms_[i]->pid(), &status, WNOHANG);
        if (ended < 0) status = W_EXITCODE(1, 0);  // its end is not known
        if (ended != 0) note_end(i, status, now);
    }
    if (now >= ask_at_) {
        if (rooms_.size() > 1) signal_descendants(SIGTERM, -1);  // also to what a script has started
        ask_at_ = kNever;
        kill_at_ = now + kPatience;
    }
    if (now >= kill_at_) signal_all(SIGKILL);
    reap_orphans();
}

// As init does: else a script that waits for the end of its daemon would wait for ever.
void Programs::reap_orphans() const {
    const auto has_waiter = [this](pid_t child) {
        const auto is_room = [child](const auto& room) { return room->pid() == child; };
        return child == spared_ || std::any_of(rooms_.begin(), rooms_.end(), is_room);
    };
    for (siginfo_t ended{}; waitid(P_ALL, 0, &ended, WEXITED | WNOHANG | WNOWAIT) == 0; ended = {}) {
        if (ended.si_pid == 0 || has_waiter(ended.si_pid)) return;
        waitpid(ended.si_pid, nullptr, 0);
    }
}

void Programs::note_end(std::size_t program, int status, SessionTime now) {
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    const bool by_signal = code == 128 + SIGTERM || code == 128 + SIGKILL;
    // Asked because the other has ended, a program may exit with any code.
    const bool ended_by_us = kill_at_ != kNever && (by_signal || asked_ == 0);
    const int counted = ended_by_us ? asked_code_ : code;
    codes_[program] = code;
    if (exit_code_ == 0) exit_code_ = counted;
    if (kill_at_ == kNever) ask_at_ = now;
}

bool Programs::all_ended() const {
    return std::all_of(codes_.begin(), codes_.end(), [](const auto& code) { return code.has_value(); });
}

}  // namespace thimble
