// The orders of views in the three kinds of sessions: of a participant, of a plain run, of free play.
#pragma once

#include <atomic>
#include <deque>
#include <optional>

#include "session/participant/prompt.hpp"
#include "session/play/session_observer.hpp"

namespace thimble {

// An experimenter's orders in a participant session, as the lines of prompt.hpp: an order does what the typed command does, no more.
//   Start, Resume   an empty line: go on         Repeat   r        Exclude   x        Quit   q
// Where no experimenter is asked, Pause holds back the next trial. It refuses orders that a participant session has
// no line for (another delay or network, ending a trial): the plan sets its conditions.
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
    bool go_on_ = false;  // a view repeats its order: one counts
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

// Free play: which trial comes next, and what a player's orders do to the running one. No clock, no socket.
//
// The first trial begins by itself. A pause after a trial has ended, another one of the same modality follows. After EndTrial
// no trial begins until a Start.
class PlayHandler final : public OrderHandler {
  public:
    static constexpr Duration kBetweenTrials = std::chrono::seconds{2};
    // The longest delay that a player may order: twice the slider's range.
    static constexpr double kLongestDelay_s = 1;

    explicit PlayHandler(Modality first) : next_(first) {}
    // The session that carries out the orders; outlives the handler, or is replaced.
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
