// Two flows from a person at the screen: the place of the hand (mouse, trackpad, gamepad), and the request to go on.
#pragma once

#include <boost/core/noncopyable.hpp>

#include "common/flow.hpp"
#include "common/messages.hpp"
#include "common/time.hpp"

namespace thimble {

// Where the hand is. Asked by the node's thread while another may move the hand.
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
    HandFlow(std::uint64_t instance, Channel* out, HandSource* hand);

    void start_trial();
    void work(SessionTime now, bool running, std::uint32_t trial);
    // When to look again; kNever outside of trials.
    SessionTime next() const { return next_look_; }

  private:
    bool news(const HandInput& hand) const;

    OutboundFlow flow_;
    HandSource* hand_;
    HandInput said_;
    SessionTime next_look_ = kNever;
    SessionTime said_at_{};
    bool said_any_ = false;  // in this trial
};

// A subject's request to go on, on its way to the session. UDP loses messages, so the node repeats it until the session turns the page.
// It holds for the page that the subject has read, and for no other.
class GoOnRequest {
  public:
    static constexpr Duration kLook = std::chrono::milliseconds{20};    // for a key, while a page waits
    static constexpr Duration kRepeat = std::chrono::milliseconds{50};  // as a view's orders
    static constexpr Duration kPatience = std::chrono::seconds{2};      // then the session will not

    // `enabled`: the protocol lets the subject go on.
    explicit GoOnRequest(bool enabled) : enabled_(enabled) {}

    // The page shown now; the same one again changes nothing.
    void turn(SessionTime now, const Page& page);
    void press(SessionTime now);
    // Whether to say it now.
    bool take_due(SessionTime now);
    // When to look for a key and call take_due() again; kNever while no page waits.
    SessionTime next() const { return next_look_; }

  private:
    bool enabled_;
    bool wanted_ = false;
    PageKind kind_ = PageKind::kNone;
    std::uint32_t trial_ = 0;
    SessionTime next_look_ = kNever, next_saying_{}, until_{};
};

}  // namespace thimble
