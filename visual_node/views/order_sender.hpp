// Repeats the user's orders until the Monitor shows their effect: UDP loses messages, and each press of a button must
// count.
#pragma once

#include <array>
#include <cstdint>

#include "common/flow.hpp"
#include "common/messages.hpp"

namespace thimble {

inline constexpr Duration kOrderRepeat = std::chrono::milliseconds{50};
inline constexpr Duration kOrderPatience = std::chrono::seconds{2};
// Repeats of an order whose effect no Monitor shows, as many as of slave_sim's beep.
inline constexpr int kUnseenOrderTimes = 5;

enum class OrderProgress : std::uint8_t {
    kNone,        // never asked, or called off by its opposite
    kAsking,      // repeated every 50 ms
    kShown,       // the Monitor shows it
    kSent,        // said five times; no Monitor shows a Repeat, an Exclude or a Speed
    kUnanswered,  // 2 s have passed: the session does not answer
};

// The session's state in its last message.
struct SessionView {
    Monitor monitor;
    std::uint32_t trial = 0;
    bool silent = true;
    double replay_speed = 1;  // 1 as well where no recorded trial is shown
};

class OrderSender {
  public:
    // `instance`: random per program start. `channel` outlives the sender.
    OrderSender(std::uint64_t instance, Channel& channel);

    // Sends at once. The header names the trial that `session` shows, so that a late EndTrial does not end the next
    // trial. An order replaces a pending one of its kind (a slider that moves). Pause cancels Resume and the reverse,
    // Start cancels EndTrial, Delay cancels Network and the reverse.
    void ask(SessionTime now, const Order& order, const SessionView& session);
    // Repeats orders that are due; ends those that took effect or too long.
    void update(SessionTime now, const SessionView& session);

    OrderProgress progress(OrderKind kind) const { return at(kind).progress; }
    const Order& asked(OrderKind kind) const { return at(kind).order; }
    // Whether something is being repeated.
    bool asking() const;
    // The order that was last left unanswered, null once the session has answered any, or another was asked.
    const Order* unanswered() const { return unanswered_; }

  private:
    static constexpr std::size_t kKinds = static_cast<std::size_t>(OrderKind::kNetwork) + 1;
    struct Asked {
        Order order;
        std::uint32_t trial = 0;  // what the Monitor said then
        SessionTime since{}, next{};
        int times = 0;
        OrderProgress progress = OrderProgress::kNone;
    };

    const Asked& at(OrderKind kind) const { return asked_[static_cast<std::size_t>(kind)]; }
    Asked& at(OrderKind kind) { return asked_[static_cast<std::size_t>(kind)]; }
    void call_off(OrderKind kind);
    void say(SessionTime now, Asked& asked);
    void step(SessionTime now, Asked& asked, const SessionView& session);
    static bool shows(const Asked& asked, const SessionView& session);

    OutboundFlow flow_;
    std::array<Asked, kKinds> asked_{};
    const Order* unanswered_ = nullptr;
};

// "delay", "pause": for messages to people.
const char* to_string(OrderKind kind);

}  // namespace thimble
