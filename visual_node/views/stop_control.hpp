// The emergency stop of a view: sends it directly to every program, knows whether a stop is active, and releases it.
// No clock: `now` is the caller's.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "common/stop_inquiry.hpp"

namespace thimble {

class StopControl : boost::noncopyable {
  public:
    // Only a press of this length releases a stop, because forces come back then.
    static constexpr Duration kHeldPress = std::chrono::seconds{1};

    // `instance`: random per start. `at`: where the programs hear stops; outlives this.
    StopControl(std::uint64_t instance, const StopOutlets& at)
        : instance_(instance),
          at_(at),
          out_(Role::kExperimenter, instance, {at[0], at[1], at[2], at[3], at[4], at[5]}) {}

    // A session that hangs passes nothing on, so the stop goes to every program.
    void stop(SessionTime now, std::string_view words) {
        order_ = StopOrder(new_number(), StopKind::kStop, EndReason::kEmergencyStop, words);
        left_ = kReleaseTimes;
        release_.reset();
        inquire(now, order_.id);
        releases_ = false;  // a press that is under way does not release it
        next_ = now;
        tick(now);
    }
    void release(SessionTime now) {
        if (release_) return;
        ++instance_;  // a flow of its own
        release_.emplace(instance_, at_);
        rounds_ = 0;
        next_ = now;
    }

    // The button, in each frame. A press that begins while no stop holds stops at once and does nothing else, however long it
    // lasts. One that begins while a stop holds releases it after kHeldPress. Returns how near that is, 0 to 1.
    double press(SessionTime now, bool pressed, std::string_view words) {
        if (!pressed) {
            pressed_ = releases_ = false;
            return 0;
        }
        if (!std::exchange(pressed_, true)) {
            since_ = now;
            releases_ = holds_;
            if (!holds_) stop(now, words);
        }
        if (!releases_) return 0;
        if (now - since_ < kHeldPress) return to_seconds(now - since_) / to_seconds(kHeldPress);
        releases_ = false;
        release(now);
        return 1;
    }

    void tick(SessionTime now) {
        if (now < next_) return;
        next_ = now + kStopRepeat;
        if (release_) return go_on_releasing(now);
        if (left_ > 0) {  // programs answer the stop, and no question that comes with it
            --left_;
            out_.send(now, 0, order_);
        } else if (now >= next_look_) {
            look(now);
        }
        hear(now);
    }

    // Whether a stop is active, from the programs' answers.
    bool holds() const { return holds_; }

  private:
    static constexpr Duration kLook = std::chrono::milliseconds{500};

    void go_on_releasing(SessionTime now) {
        release_->round(now);
        if (++rounds_ < StopRelease::kRounds) return;
        release_.reset();
        inquiry_.reset();
        holds_ = false;
        next_look_ = now;
    }

    // A new inquiry each time, because an inquiry keeps its answers.
    void look(SessionTime now) {
        if (inquiry_) holds_ = !inquiry_->held().empty();
        inquire(now, new_number());
        inquiry_->ask(now);
    }

    void inquire(SessionTime now, std::uint64_t number) {
        inquiry_.emplace(out_, at_, number);
        next_look_ = now + kLook;
    }

    void hear(SessionTime now) {
        if (!inquiry_) return;
        inquiry_->hear(now);
        if (!inquiry_->held().empty()) holds_ = true;
    }

    // Of a stop or a question. The factor is odd: no number comes twice.
    std::uint64_t new_number() { return instance_ + 0x9E3779B97F4A7C15U * ++numbers_; }

    std::uint64_t instance_, numbers_ = 0;
    StopOutlets at_;
    OutboundFlow out_;
    StopOrder order_;
    std::optional<StopInquiry> inquiry_;
    std::optional<StopRelease> release_;
    SessionTime next_{}, next_look_{}, since_{};
    int left_ = 0, rounds_ = 0;
    bool holds_ = false, pressed_ = false, releases_ = false;
};

}  // namespace thimble
