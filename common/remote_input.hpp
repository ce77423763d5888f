// One number that another program sends again and again, as a hand's position or a robot's force. Pure: the caller has the messages.
//
// Numbers come from one writer, until it has been silent for kLostAfter; what a second one sends meanwhile is
// refused. A number is refused and counted if it is none, out of reach, or further from the last one than it can get
// meanwhile. Without a good one for kStaleAfter the input is stale, for kLostAfter it is lost. The next trial takes
// the first good number, whatever it is.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include <nlohmann/json.hpp>

#include "common/time.hpp"

namespace thimble {

// `fastest_per_s` holds for as long as a number is not stale; `noise` is an encoder's.
struct RemoteRules {
    double reach = 1, fastest_per_s = 5, noise = 0.001;
};

class RemoteInput {
  public:
    static constexpr Duration kStaleAfter = std::chrono::milliseconds{20};
    static constexpr Duration kLostAfter = std::chrono::milliseconds{300};  // before slave_sim gives up

    explicit RemoteInput(const RemoteRules& rules = {}) : rules_(rules) {}

    void start_trial(SessionTime now) {
        placed_ = lost_ = second_writer_ = false;
        heard_ = now;
    }
    // Call it before the messages that have arrived by `now`. It fixes how far the number may have moved; refused
    // numbers do not widen that.
    void open(SessionTime now) {
        if (now == opened_) return;
        const Duration passed = came_ ? std::min<Duration>(now - *came_, kStaleAfter) : kStaleAfter;
        allowance_ = rules_.fastest_per_s * to_seconds(passed) + rules_.noise;
        base_ = value_;
        opened_ = now;
    }
    // Oldest first.
    void take(SessionTime now, std::uint64_t writer, double value) {
        if (came_ && writer != writer_ && now - *came_ <= kLostAfter) {
            ++other_writers_;
            second_writer_ = true;
            return;
        }
        writer_ = writer;
        came_ = now;
        if (!std::isfinite(value) || std::fabs(value) > rules_.reach) {
            ++not_numbers_;
            return;
        }
        if (!placed_) base_ = value;
        if (std::fabs(value - base_) > allowance_) {
            ++jumps_;
            return;
        }
        ++taken_;
        value_ = value;
        heard_ = now;
        placed_ = true;
    }
    // Call it after them. Outside a trial a lost input is taken again wherever it is; in a trial it stays lost.
    void close(SessionTime now) {
        if (now - heard_ <= kLostAfter) return;
        lost_ = true;
        placed_ = false;
    }
    // In a trial: is it stale? Each time that it becomes so counts.
    bool look(SessionTime now) {
        const bool stale = now - heard_ > kStaleAfter;
        if (stale && !stale_) ++stales_;
        stale_ = stale;
        return stale;
    }

    double value() const { return value_; }
    bool placed() const { return placed_; }
    bool stale() const { return stale_; }  // as the last look() saw it
    bool lost() const { return lost_; }    // since start_trial()
    bool second_writer() const { return second_writer_; }
    bool heard_within(SessionTime now, Duration limit) const { return placed_ && now - heard_ < limit; }

    // {name: taken, and why others were refused}
    nlohmann::ordered_json describe(const char* name) const {
        return {{name, taken_},
                {"not_numbers", not_numbers_},
                {"jumps", jumps_},
                {"other_writers", other_writers_},
                {"stale", stales_}};
    }

  private:
    RemoteRules rules_;
    bool placed_ = false, stale_ = false, lost_ = false, second_writer_ = false;
    double value_ = 0, base_ = 0, allowance_ = 0;  // a number is within `allowance_` of `base_`
    std::uint64_t writer_ = 0;
    std::optional<SessionTime> came_;  // the writer's last message, good or not
    SessionTime heard_{};              // the last good one
    std::optional<SessionTime> opened_;
    std::uint64_t taken_ = 0, not_numbers_ = 0, jumps_ = 0, other_writers_ = 0, stales_ = 0;
};

}  // namespace thimble
