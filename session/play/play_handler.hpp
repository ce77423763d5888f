// Free play: which trial comes next, and what a player's orders do to the running one. No clock, no socket.
//
// The first trial begins by itself; one that has come to its end is followed by another of the same modality after a pause;
// after EndTrial nothing begins until somebody says Start.
#pragma once

#include <optional>

#include "session/play/monitor_feed.hpp"
#include "session/play/order_taker.hpp"

namespace thimble {

class PlayHandler final : public OrderHandler {
  public:
    static constexpr Duration kBetweenTrials = std::chrono::seconds{2};
    // Twice what the panel's slider has.
    static constexpr double kLongestDelay_s = 1;

    explicit PlayHandler(Modality first) : next_(first) {}
    // The session that obeys; outlives the handler, or is replaced.
    void serve(SessionProcess& session) { session_ = &session; }

    std::optional<Refusal> obey(SessionTime now, const Order& order) override;
    // The trial to begin now, if there is one; it is then no longer due.
    std::optional<Modality> take_due(SessionTime now);
    void trial_ended(SessionTime now, const TrialRecord& record);

    bool quit() const { return quit_; }
    const MonitorContext& context() const { return context_; }

  private:
    void end_running();

    SessionProcess* session_ = nullptr;
    std::optional<Modality> next_;
    SessionTime not_before_{};
    MonitorContext context_;
    bool quit_ = false;
};

}  // namespace thimble
