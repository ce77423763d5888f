// Two flows from a person at the screen: the place of the hand (mouse, trackpad, gamepad), and the request to go on.
#pragma once

#include <cassert>
#include <cstdint>

#include <boost/core/noncopyable.hpp>

#include "common/flow.hpp"
#include "common/messages.hpp"
#include "common/time.hpp"

namespace thimble {

// Where a player's hand is read: in the window, or by the master ([handle] device = "hid").
enum class HandKind : std::uint8_t { kMouse, kKeyboard, kDevice };

// The position of the hand. The node's thread asks while another thread may move it.
class HandSource : boost::noncopyable {
  public:
    virtual ~HandSource() = default;

    virtual HandInput hand() const = 0;
    // A trial begins: where the hand is now is position 0, outside the tissue.
    virtual void home() = 0;
};

// The hand on its way to the master: at most every 1 ms while the hand moves, every 10 ms as a sign of life, and at once when it lets go.
class HandFlow {
  public:
    static constexpr Duration kPeriod = std::chrono::milliseconds{1};
    static constexpr Duration kSignOfLife = std::chrono::milliseconds{10};

    // Both null: no hand here, never a message.
    HandFlow(std::uint64_t instance, Channel* out, HandSource* hand)
        : flow_(Role::kVisual, instance, {out}), hand_(hand) {
        assert((out == nullptr) == (hand == nullptr));
    }

    void start_trial() {
        if (hand_ == nullptr) return;
        hand_->home();
        said_any_ = false;
        next_look_ = {};
    }

    void work(SessionTime now, bool running, std::uint32_t trial) {
        if (hand_ == nullptr || !running) {
            next_look_ = kNever;
            return;
        }
        if (now < next_look_) return;
        next_look_ = now + kPeriod;
        const HandInput hand = hand_->hand();
        if (!news(hand) && now - said_at_ < kSignOfLife) return;
        flow_.send(now, trial, hand);
        said_ = hand;
        said_at_ = now;
        said_any_ = true;
    }

    // When to look again; kNever outside of trials.
    SessionTime next() const { return next_look_; }

  private:
    bool news(const HandInput& hand) const {
        return !said_any_ || hand.engaged != said_.engaged || hand.position_hand_m != said_.position_hand_m;
    }

    OutboundFlow flow_;
    HandSource* hand_;
    HandInput said_;
    SessionTime next_look_ = kNever;
    SessionTime said_at_{};
    bool said_any_ = false;  // in this trial
};

// A subject's request to go on, or answer to a question, on its way to the session. UDP loses messages, so the node
// repeats it until the session turns the page. It holds for the page that the subject has read, and for no other.
class GoOnRequest {
  public:
    static constexpr Duration kLook = std::chrono::milliseconds{20};    // for a key, while a page waits
    static constexpr Duration kRepeat = std::chrono::milliseconds{50};  // as a view's orders
    static constexpr Duration kPatience = std::chrono::seconds{2};      // then the session will not go on

    // `enabled`: the protocol lets the subject go on.
    explicit GoOnRequest(bool enabled) : enabled_(enabled) {}

    // The page shown now; the same one again changes nothing.
    void turn(SessionTime now, const Page& page) {
        if (page.kind == kind_ && page.trial == trial_) return;
        kind_ = page.kind;
        trial_ = page.trial;
        wanted_ = false;
        next_look_ = asks() || (enabled_ && waits_to_go_on(kind_)) ? now : kNever;
    }

    void press(SessionTime now) {
        if (next_look_ == kNever || wanted_ || asks()) return;
        want(now, now + kPatience);
    }

    // An answer to the question that is shown; the last one counts until the session turns the page. Answers to other
    // questions are ignored.
    void answer(SessionTime now, std::uint32_t question, double value) {
        if (!asks() || question != trial_) return;
        value_ = value;
        want(now, kNever);
    }

    // Whether to say it now.
    bool take_due(SessionTime now) {
        if (next_look_ == kNever) return false;
        next_look_ = now + kLook;
        if (wanted_ && now >= until_) wanted_ = false;
        if (!wanted_ || now < next_saying_) return false;
        next_saying_ = now + kRepeat;
        return true;
    }

    Order order() const {
        Order order;
        order.kind = asks() ? OrderKind::kAnswer : OrderKind::kResume;
        if (asks()) {
            order.trial = trial_;
            order.value = value_;
        }
        return order;
    }

    // When to look for a key and call take_due() again; kNever while no page waits.
    SessionTime next() const { return next_look_; }

  private:
    bool asks() const { return kind_ == PageKind::kQuestion; }
    void want(SessionTime now, SessionTime until) {
        wanted_ = true;
        next_saying_ = now;
        until_ = until;
    }

    bool enabled_;
    bool wanted_ = false;
    double value_ = 0;  // of the answer
    PageKind kind_ = PageKind::kNone;
    std::uint32_t trial_ = 0;
    SessionTime next_look_ = kNever, next_saying_{}, until_{};
};

}  // namespace thimble
