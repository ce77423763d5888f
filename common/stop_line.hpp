// The stop line: one channel per program on which everybody hears everybody, beside the session and not by way of it. Whoever
// stops says so again and again until somebody releases it on purpose; until then no trial begins anywhere.
//
// A stop and a release each have a random number: what is said again, or comes late, is carried out once. A release lets go of
// what has been held for kHeldAtLeast and longer: whoever presses stop while a release is on its way has stopped. Anybody may
// stop; only the session and the experimenter may release. No clock: `now` is the caller's.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "common/flow.hpp"
#include "common/messages.hpp"

namespace thimble {

// How often a stop is said while it holds, and a release for kReleaseTimes.
inline constexpr Duration kStopRepeat = std::chrono::milliseconds{50};
inline constexpr int kReleaseTimes = 10;
// Longer than a release is on its way, shorter than anybody needs to find out why somebody stopped.
inline constexpr Duration kHeldAtLeast = std::chrono::milliseconds{200};
// What every message about a stop ends with.
inline constexpr std::string_view kHowToRelease = "release it with: thimble stop --release";

// Where the programs of a session hear of stops, in the order of kStopPorts (network_settings.hpp).
using StopOutlets = std::array<Channel*, 6>;

class StopLine {
  public:
    // `instance`: random per process start.
    StopLine(Role role, std::uint64_t instance)
        : role_(role), instance_(instance), out_(role, instance, {}) {}
    // `in`: where this program hears; `out`: where the others do, its own place may be among them. All outlive the line. Without
    // it a stop holds here only.
    void connect(Channel& in, const StopOutlets& out);

    // Takes what has come, says what is due.
    void tick(SessionTime now);
    SessionTime next() const { return next_; }

    // Stops everything (is_stop(reason)); harmless where it holds already. `words`: who and why, without how to release.
    void stop(SessionTime now, EndReason reason, std::string_view words);
    void release(SessionTime now);

    bool stopped() const { return held_count_ > 0; }
    // Of the oldest stop that holds, and once released of the last one.
    EndReason reason() const { return held_.front().order.reason; }
    std::string_view words() const { return held_.front().order.words(); }
    Role raised_by() const { return held_.front().from; }
    const FlowCounters& counters() const { return counters_; }

  private:
    static constexpr std::size_t kHeld = 8, kRemembered = 32;
    struct Held {
        StopOrder order;
        Role from = Role::kSession;
        SessionTime since{};
    };

    void take(SessionTime now, Bytes datagram);
    void obey(SessionTime now, Role sender, const StopOrder& order);
    void hold(SessionTime now, Role sender, const StopOrder& order);
    void let_go(SessionTime now, std::uint64_t release);
    bool holds(std::uint64_t id) const;
    bool released(std::uint64_t id) const;
    void remember(std::uint64_t id);
    std::uint64_t new_id();

    Role role_;
    std::uint64_t instance_;
    std::uint64_t made_ = 0;
    Channel* in_ = nullptr;
    OutboundFlow out_;
    std::array<Held, kHeld> held_{};  // oldest first
    std::size_t held_count_ = 0;
    std::array<std::uint64_t, kRemembered> done_{};  // stops that were released, and releases; a ring
    std::size_t done_next_ = 0;
    StopOrder own_, own_release_;
    bool saying_ = false;  // own_
    int releases_left_ = 0;
    SessionTime next_ = kNever;
    FlowCounters counters_;
    Message message_;
};

}  // namespace thimble
