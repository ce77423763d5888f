// Drives one process in real time: absolute deadlines, and at once when a datagram arrives. The whole loop
// fits on one screen (realtime_loop.cpp).
#pragma once

#include <atomic>
#include <functional>
#include <sched.h>
#include <span>
#include <sys/types.h>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "common/histogram.hpp"
#include "common/process.hpp"
#include "common/runtime/event_waiter.hpp"
#include "common/runtime/listener.hpp"
#include "common/runtime/runtime_settings.hpp"

namespace thimble {

struct LoopStatistics {
    Histogram lateness;            // wake-up after its deadline
    Histogram turns;               // from a wake-up to the next wait: the node's own share of a round trip
    std::uint64_t deadlines = 0;   // timed wake-ups
    std::uint64_t missed = 0;      // later than kDeadlineSlack
    unsigned missed_in_a_row = 0;  // until now
    std::uint64_t arrivals = 0;    // wake-ups by a datagram
};

// A tick that starts a whole sample late has missed its sample.
inline constexpr Duration kDeadlineSlack = std::chrono::milliseconds{1};

// SIGQUIT (Ctrl-\ in a terminal) ends the program as Ctrl-C does, or is an emergency stop of everything: that is for
// programs that ask emergency_stops().
enum class QuitSignal { kEnds, kStopsEverything };

// True after SIGINT or SIGTERM, once install_stop_signals() was called.
const std::atomic<bool>& stop_requested();
// Number of these signals. A second one asks a program that is ending to end at once.
unsigned stop_requests();
void install_stop_signals(QuitSignal quit = QuitSignal::kEnds);
// In a thread beside the loop: signals are for the loop's own.
void block_signals();
// How many emergency stops SIGQUIT has asked for since the program began. A loop that obeys them counts from 0: one that
// came while devices were made ready still holds.
unsigned emergency_stops();
// The kernel sends SIGTERM to this process when the thread that started it ends. If the process `launcher` has ended already,
// SIGTERM comes at once. A `launcher` of 1 (the flag alone) means that its number is unknown.
void stop_with_parent(pid_t launcher);
inline constexpr const char* kDieWithParentHelp =
    "end with the launcher; =PID: also if that process has already ended (set by thimble run)";

// Real-time scheduling and a 1 ns timer slack for this thread. Returns "" or what to tell the user (said
// once).
std::string ask_for_realtime(const RuntimeSettings& settings);

// While it lives the thread that made it has real-time scheduling, one step below what the settings name for the nodes, if
// that is granted; programs that it starts do not inherit it. Made and ended by the same thread.
class RealtimeLease : boost::noncopyable {
  public:
    explicit RealtimeLease(const RuntimeSettings& settings);
    ~RealtimeLease();

    bool granted() const { return granted_; }

  private:
    sched_param before_{};
    int policy_before_ = 0;
    bool granted_ = false;
};

class RealtimeLoop : boost::noncopyable {
  public:
    // Wakes on mail for `listeners`, which outlive the loop: from now on they receive nothing but in a step of it.
    // Throws Error (network) if the kernel refuses a timer.
    explicit RealtimeLoop(std::span<Listener* const> listeners);
    ~RealtimeLoop();

    // One wait and one tick, waiting no longer than `latest`.
    void step(Process& process, SessionTime latest);
    // Until the process has stopped or a stop is requested. `turned`, if there is one, is called after each step.
    void run(Process& process, const std::function<void(SessionTime now)>& turned = {});

    const LoopStatistics& statistics() const { return statistics_; }

  private:
    SessionTime wait(SessionTime until);

    EventWaiter waiter_{false};
    std::vector<Listener*> listeners_;
    SessionTime woken_ = kNever;  // last, within run()
    LoopStatistics statistics_;
};

}  // namespace thimble
