#include "common/runtime/realtime_loop.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

std::atomic<bool> stop{false};

std::atomic<unsigned> stops{0}, emergencies{0};

extern "C" void request_stop(int /*signal*/) {
    stop = true;
    ++stops;
}
extern "C" void request_emergency_stop(int /*signal*/) { ++emergencies; }

// The system hands a dead parent's children on a moment before it reports the death.
constexpr int kDeathIsKnownWithin_ms = 50;

bool has_ended(pid_t process) {
    const auto watch = static_cast<int>(syscall(SYS_pidfd_open, process, 0U));
    if (watch < 0) return errno == ESRCH;
    pollfd end{watch, POLLIN, 0};
    const bool ended = poll(&end, 1, kDeathIsKnownWithin_ms) > 0;
    close(watch);
    return ended;
}

// How long a stop request may wait for a sleeping loop.
constexpr Duration kStopLatency = std::chrono::milliseconds{100};

}  // namespace

const std::atomic<bool>& stop_requested() { return stop; }
unsigned stop_requests() { return stops; }

void install_stop_signals(QuitSignal quit) {
    struct sigaction action {};
    action.sa_handler = request_stop;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    if (quit == QuitSignal::kStopsEverything) action.sa_handler = request_emergency_stop;
    sigaction(SIGQUIT, &action, nullptr);
    std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error of its writer
}

void block_signals() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

unsigned emergency_stops() { return emergencies; }

// A launcher that died before the first line sends no signal. A parent that is not the launcher may be a wrapper between
// the two, such as xvfb-run.
void stop_with_parent(pid_t launcher) {
    prctl(PR_SET_PDEATHSIG, SIGTERM, 0UL, 0UL, 0UL);
    if (getppid() != launcher && has_ended(launcher)) std::raise(SIGTERM);
}

std::string ask_for_realtime(const RuntimeSettings& settings) {
    // The default slack of 50 us would be added to every wake-up.
    prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
    if (!settings.realtime_scheduling) return "";
    sched_param parameter{};
    parameter.sched_priority = settings.priority;
    if (sched_setscheduler(0, SCHED_FIFO, &parameter) == 0) return "";
    return fmt::format(
        "no real-time scheduling ({}): other programs can delay this one. Allow it with 'ulimit -r {}', or "
        "set realtime_scheduling = false in [runtime]",
        std::strerror(errno), settings.priority);
}

RealtimeLease::RealtimeLease(const RuntimeSettings& settings) : policy_before_(sched_getscheduler(0)) {
    if (!settings.realtime_scheduling || policy_before_ < 0 || sched_getparam(0, &before_) != 0) return;
    sched_param wanted{};
    wanted.sched_priority = std::max(1, settings.priority - 1);
    granted_ = sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &wanted) == 0;
}

// Without privilege the flag can be set, not cleared.
RealtimeLease::~RealtimeLease() {
    if (granted_) sched_setscheduler(0, policy_before_ | SCHED_RESET_ON_FORK, &before_);
}

RealtimeLoop::RealtimeLoop(std::span<Listener* const> listeners)
    : listeners_(listeners.begin(), listeners.end()) {
    for (std::size_t i = 0; i < listeners_.size(); ++i) {
        if (!waiter_.add(listeners_[i]->file_descriptor(), i))
            throw Error(ExitCode::kRunFailed, "cannot wait for events: {}", std::strerror(errno));
    }
    for (Listener* listener : listeners_) listener->set_watched(true);
}

RealtimeLoop::~RealtimeLoop() {
    for (Listener* listener : listeners_) listener->set_watched(false);
}

// Until that moment, or mail, or a signal; returns when that was.
SessionTime RealtimeLoop::wait(SessionTime until) {
    std::array<epoll_event, 16> room{};
    for (const epoll_event& event : waiter_.wait(until, until, room)) listeners_[event.data.u64]->has_mail();
    return wall_now();
}

void RealtimeLoop::step(Process& process, SessionTime latest) {
    const SessionTime deadline = process.next_wakeup();
    const SessionTime now = wait(std::min(deadline, latest));
    if (deadline == SessionTime{}) {
        // "At once", not a deadline: nothing to be late for.
    } else if (now >= deadline) {
        ++statistics_.deadlines;
        statistics_.lateness.add(now - deadline);
        const bool missed = now - deadline > kDeadlineSlack;
        statistics_.missed += missed ? 1 : 0;
        statistics_.missed_in_a_row = missed ? statistics_.missed_in_a_row + 1 : 0;
    } else {
        ++statistics_.arrivals;
    }
    woken_ = now;
    process.tick(now);
}

void RealtimeLoop::run(Process& process, const std::function<void(SessionTime now)>& turned) {
    while (!process.stopped() && !stop) {
        const SessionTime now = wall_now();
        if (woken_ != kNever) statistics_.turns.add(now - woken_);
        step(process, now + kStopLatency);
        if (turned) turned(now);
    }
}

}  // namespace thimble
