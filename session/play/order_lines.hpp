// An experimenter's orders in a participant session, as the lines of prompt.hpp: an order does what the typed command does, no more.
//   Start, Resume   an empty line: go on         Repeat   r        Exclude   x        Quit   q
// Pause holds back the next trial where nobody is asked. It refuses orders that a participant session has no line for (another delay or network, ending a trial): the plan sets its conditions.
#pragma once

#include <atomic>
#include <deque>

#include "session/participant/line_source.hpp"
#include "session/play/monitor_feed.hpp"
#include "session/play/order_taker.hpp"

namespace thimble {

class OrderLines final : public OrderHandler, public LineSource {
  public:
    // The session that the orders are about; replaced when the nodes are started anew.
    void serve(const SessionProcess& session) { session_ = &session; }

    std::optional<Refusal> obey(SessionTime now, const Order& order) override;
    std::optional<std::string> take_line() override;
    bool ended() const override { return false; }

    MonitorContext& context() { return context_; }

  private:
    void go_on();

    const SessionProcess* session_ = nullptr;
    std::deque<std::string> lines_;
    bool go_on_ = false;  // said again until it shows: one is enough
    MonitorContext context_;
};

// In a plain run, whose trials are all planned: Quit alone, as Ctrl-C.
class QuitHandler final : public OrderHandler {
  public:
    std::optional<Refusal> obey(SessionTime now, const Order& order) override;
    bool quit() const { return quit_; }

  private:
    std::atomic<bool> quit_ = false;  // conditions side by side
};

}  // namespace thimble
