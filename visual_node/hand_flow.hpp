// A person's hand, read where the screen is (mouse, trackpad, gamepad), on its way to the master.
#pragma once

#include "common/flow.hpp"
#include "common/messages.hpp"

namespace thimble {

// Where the hand is. Asked by the node's thread while another may move the hand.
class HandSource {
  public:
    virtual ~HandSource() = default;
    HandSource() = default;
    HandSource(const HandSource&) = delete;
    HandSource& operator=(const HandSource&) = delete;

    virtual HandInput hand() const = 0;
    // A trial begins: where the hand is now is position 0, outside the tissue.
    virtual void home() = 0;
};

// At most every 1 ms while the hand moves, every 10 ms as a sign of life, and at once when it lets go.
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

}  // namespace thimble
