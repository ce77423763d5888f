// The stop bus: one channel per program on which everybody hears everybody, beside the session and not by way of it. A program that stops repeats the stop until a person releases it on purpose. Until then no trial begins anywhere.
//
// Each stop has a random number, and a release names that of the stop which it lets go of: what is said again, comes late or was
// recorded, here or at another session, lets go of nothing else. Who holds a stop passes it on every kStopPassedOn, so that the
// session knows them all and who is started anew is stopped too; and he answers a question, and a stop of the experimenter's, with what
// he holds and for how long, so that somebody who has just come can name what was held before he came (stop_inquiry.hpp), and a stop
// pressed meanwhile holds.
// Any program may stop. Only the session and the experimenter may release. No clock: `now` is the caller's.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

#include <boost/circular_buffer.hpp>
#include <boost/container/static_vector.hpp>

#include "common/flow.hpp"
#include "common/messages.hpp"

namespace thimble {

// How often a stop is said while it holds, and a release for kReleaseTimes.
inline constexpr Duration kStopRepeat = std::chrono::milliseconds{50};
inline constexpr int kReleaseTimes = 10;
inline constexpr Duration kStopPassedOn = std::chrono::milliseconds{500};
// A question is answered at most so often, so that replayed questions make no flood.
inline constexpr Duration kAnswerEvery = std::chrono::milliseconds{10};
// Shorter than a person needs to find out the reason of a stop.
inline constexpr Duration kHeldAtLeast = std::chrono::milliseconds{200};
// A press so shortly before a release arrives is a stop that the release does not mean. Longer than a release takes.
inline constexpr Duration kPressedLately = std::chrono::seconds{1};
// The end of every message about a stop.
inline constexpr std::string_view kHowToRelease = "release it with: thimble stop --release";

// Where the programs of a session hear of stops, in the order of kStopPorts (network_settings.hpp).
using StopOutlets = std::array<Channel*, 6>;

class StopBus {
  public:
    // `instance`: random per process start.
    StopBus(Role role, std::uint64_t instance) : role_(role), instance_(instance), out_(role, instance, {}) {}
    // `in`: where this program hears; `out`: where the others do, its own place may be among them. All outlive the line. Without
    // it a stop holds here only.
    void connect(Channel& in, const StopOutlets& out);

    // Takes what has come, says what is due.
    void tick(SessionTime now);
    SessionTime next() const { return next_; }

    // Stops everything (is_stop(reason)); harmless where it holds already, but that an emergency stop so said holds on when the one
    // before it is released within kPressedLately. `words`: who and why, without how to release.
    void stop(SessionTime now, EndReason reason, std::string_view words);
    // Releases the stops that have been held for kHeldAtLeast.
    void release(SessionTime now);

    bool stopped() const { return !held_.empty(); }
    // Of the oldest stop that holds, and once released of the last one.
    EndReason reason() const { return shown().order.reason; }
    std::string_view words() const { return shown().order.words(); }
    Role raised_by() const { return shown().from; }
    const FlowCounters& counters() const { return counters_; }

  private:
    static constexpr std::size_t kHeld = 32, kRemembered = 128;
    struct Held {
        StopOrder order;
        Role from = Role::kSession;
        SessionTime since{};
    };

    void take(SessionTime now, Bytes datagram);
    void obey(SessionTime now, Role sender, const StopOrder& order);
    void hold(SessionTime now, Role sender, const StopOrder& order);
    void make_room(SessionTime now);
    void say(SessionTime now, EndReason reason, std::string_view words);
    void let_go(SessionTime now, std::uint64_t id);
    void remind(SessionTime now, std::uint64_t id);
    void answer(SessionTime now);
    void say_what_is_due(SessionTime now);
    void repeat(SessionTime now, std::uint64_t release);
    const Held& shown() const { return held_.empty() ? last_ : held_.front(); }
    auto find(std::uint64_t id) {
        return std::find_if(held_.begin(), held_.end(), [id](const Held& one) { return one.order.id == id; });
    }
    bool released(std::uint64_t id) const {
        return std::find(released_.begin(), released_.end(), id) != released_.end();
    }
    std::uint64_t new_id();

    Role role_;
    std::uint64_t instance_;
    std::uint64_t made_ = 0;
    Channel* in_ = nullptr;
    OutboundFlow out_;
    boost::container::static_vector<Held, kHeld> held_;            // oldest first
    Held last_;                                                    // that was released
    boost::circular_buffer<std::uint64_t> released_{kRemembered};  // stops
    StopOrder own_;
    bool saying_ = false;          // own_
    SessionTime pressed_until_{};  // again, while saying; plus kPressedLately
    boost::container::static_vector<std::uint64_t, kHeld> releasing_;  // stops
    int releases_left_ = 0;
    SessionTime next_ = kNever, next_passed_on_ = kNever;
    SessionTime next_reminder_{}, next_answer_{};
    Encoder encoder_;
    std::uint32_t answers_ = 0;
    FlowCounters counters_;
    Message message_;
};

}  // namespace thimble
