// Emergency-stop bus: every program sends to every other one, without the session in between. A program that stops
// repeats the stop until a person releases it. Until then no trial begins anywhere.
//
// Each stop has a random number. A release names the number of one stop, so a repeated, late or recorded release
// affects no other stop. Each program rebroadcasts its active stops every kStopPassedOn: so the session knows them
// all, and a restarted program is stopped too. It answers a question, and a stop of the experimenter, with its active
// stops and their ages. So a program that has just started can name the stops from before its start
// (stop_inquiry.hpp), and a stop pressed meanwhile stays active. An answer repeats the number of what it answers, so a
// recorded one counts for nothing.
//
// Any program may stop. Only the session and the experimenter may release. No clock: `now` is the caller's.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "common/flow.hpp"
#include "common/messages.hpp"

namespace thimble {

// Period of repeats: of a stop while it is held, and of a release kReleaseTimes times.
inline constexpr Duration kStopRepeat = std::chrono::milliseconds{50};
inline constexpr int kReleaseTimes = 10;
inline constexpr Duration kStopPassedOn = std::chrono::milliseconds{500};
// Least time between two answers, so that replayed questions cause no flood.
inline constexpr Duration kAnswerEvery = std::chrono::milliseconds{10};
// A release needs a stop that was held this long: a person needs longer to find its reason.
inline constexpr Duration kHeldAtLeast = std::chrono::milliseconds{200};
// A program that repeats its own stop within this time before the release stops anew: who released cannot have known of it.
// A first press is kept by kHeldAtLeast alone.
inline constexpr Duration kPressedLately = std::chrono::seconds{1};
// The end of every message about a stop.
inline constexpr std::string_view kHowToRelease = "release it with: thimble stop --release";

// An answer repeats this part of the number of a question or of a stop, in the place of a trial.
constexpr std::uint32_t number_in_answer(std::uint64_t id) { return static_cast<std::uint32_t>(id); }

// Outlets to the stop buses of all programs, in the order of kStopPorts (network_settings.hpp).
using StopOutlets = std::array<Channel*, 6>;

class StopBus {
  public:
    // `instance`: random per process start.
    StopBus(Role role, std::uint64_t instance);
    // `in`: this program's inlet; `out`: outlets to the others, its own may be among them. All outlive the bus.
    // Without it a stop holds in this program only.
    void connect(Channel& in, const StopOutlets& out);

    // Takes the messages that have arrived and sends what is due.
    void tick(SessionTime now) {
        if (now >= next_ || (in_ != nullptr && !in_->known_empty())) hear_and_say(now);
    }
    SessionTime next() const { return next_; }

    // Stops everything (is_stop(reason)). Repeating a stop changes nothing, with one exception: an emergency stop
    // that is repeated within kPressedLately before a release survives the release. `words`: who stopped and why,
    // without how to release.
    void stop(SessionTime now, EndReason reason, std::string_view words);
    // Releases the stops that have been held for kHeldAtLeast.
    void release(SessionTime now);

    bool stopped() const { return !held_.empty(); }
    // The reason of the oldest stop that holds; after the release that of the last one.
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

    void hear_and_say(SessionTime now);
    void take(SessionTime now, Bytes datagram);
    void obey(SessionTime now, Role sender, const StopOrder& order);
    void hold(SessionTime now, Role sender, const StopOrder& order);
    void make_room(SessionTime now);
    void say(SessionTime now, EndReason reason, std::string_view words);
    void release_one(SessionTime now, std::uint64_t id);
    void remind(SessionTime now, std::uint64_t id);
    void answer(SessionTime now, std::uint64_t id);
    void say_what_is_due(SessionTime now);
    void repeat(SessionTime now, std::uint64_t release);
    const Held& shown() const { return held_.empty() ? last_ : held_.front(); }
    auto find(std::uint64_t id) {
        return std::find_if(held_.begin(), held_.end(), [id](const Held& one) { return one.order.id == id; });
    }
    bool released(std::uint64_t id) const;
    std::uint64_t new_id();

    Role role_;
    std::uint64_t instance_;
    std::uint64_t made_ = 0;
    OutboundFlow out_;
    Held last_;                                          // that was released
    std::array<std::uint64_t, kRemembered> released_{};  // stops: the last ones of released_count_
    std::size_t released_count_ = 0;
    StopOrder own_;
    bool saying_ = false;                   // own_
    SessionTime pressed_until_{};           // again, while saying; plus kPressedLately
    std::vector<std::uint64_t> releasing_;  // stops
    int releases_left_ = 0;
    SessionTime next_passed_on_ = kNever;
    SessionTime next_reminder_{}, next_answer_{};
    Encoder encoder_;
    std::uint32_t answers_ = 0;
    FlowCounters counters_;
    Message message_;
    // Last: each tick reads these, and how many are held.
    std::vector<Held> held_;  // oldest first
    Channel* in_ = nullptr;
    SessionTime next_ = kNever;
};

}  // namespace thimble
