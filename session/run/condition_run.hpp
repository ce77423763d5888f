// One condition of a real-time run: five node processes, here or on other machines, a session that steers them through
// its trials, everything recorded as it comes.
#pragma once

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

#include <boost/core/noncopyable.hpp>

#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/sockets.hpp"
#include "session/run/condition_files.hpp"
#include "session/run/condition_nodes.hpp"
#include "session/run/condition_plan.hpp"
#include "session/run/run_outcome.hpp"
#include "session/run/session_process.hpp"
#include "session/run/session_stop.hpp"

namespace thimble {

class ConditionRun : boost::noncopyable {
  public:
    // `plan` and `events` outlive the condition. Throws Error: network, if a port is taken.
    ConditionRun(const ConditionPlan& plan, const ConditionEvents& events);
    ~ConditionRun() = default;  // ends the nodes, all at once

    // Starts the nodes, unless they run already, and waits for them. Throws Error:
    // - run failed, if a stop of an earlier session holds (stop_file.hpp), or a machine has no such program or another version;
    // - network, with the words of the node that failed.
    void open();
    // Throws Error (network), with its words, if a node has ended by itself and the run was not told to end.
    void check();
    // Runs one trial to its end, which may be that a peer was lost or a stop was asked for. `number` tells it
    // apart from the last one on the wire (session_process.hpp).
    const TrialRecord& run_trial(const TrialConditions& trial, std::uint32_t number,
                                 const std::filesystem::path& trajectory);  // empty: none is written
    std::uint32_t last_number() const { return session_.last_number(); }
    // The trial's own number, unless nodes that went on running have seen it: they obey no order twice.
    std::uint32_t free_number(const TrialConditions& trial) const {
        return std::max(trial.trial, std::max(session_.number(), last_number()) + 1);
    }
    // The page that the subject's screen shows until the next trial.
    void show(const Page& page) { session_.show(page); }
    // Whether the subject has asked to go on from it since the last call.
    bool take_go_on() { return session_.take_go_on(); }
    std::optional<double> take_answer() { return session_.take_answer(); }
    // Keeps in touch with the nodes between trials, for at most `limit`.
    void idle(Duration limit);
    // A node has ended, or was lost: this condition runs no further trial. After a stop it does, once that was released.
    bool broken() { return (outcome_.failed() && !outcome_.halted()) || nodes_.dead(); }
    // Of a stop: its source, its reason and how to release it. Empty: no stop holds.
    std::string stop_text() const { return stop_.words(); }
    void emergency_stop(std::string_view words);
    void release_stop();
    // Starts the ended nodes anew and waits for them. They take part from the next trial on. False if none had ended. Throws Error
    // as open() does.
    bool revive();
    // The result so far: not ok after a lost peer or a stop.
    const ConditionResult& result() const { return outcome_.result(); }
    // Ends the nodes that open() started and collects their reports.
    ConditionResult close();

  private:
    // Session and observer as one process, between the two halves of the sockets' protection.
    class SessionAndObserver final : public Process {
      public:
        SessionAndObserver(SessionProcess& session, std::unique_ptr<Observer> observer, Security* security)
            : session_(&session), observer_(std::move(observer)), security_(security) {}
        void tick(SessionTime now) override;
        SessionTime next_wakeup() const override;
        bool stopped() const override { return false; }

      private:
        SessionProcess* session_;
        std::unique_ptr<Observer> observer_;
        Security* security_;
    };

    void turn(SessionTime until);
    void turn_before_trials();
    void wait_for_nodes();
    std::string why_silent() const;
    void look_around();
    void close_trial();
    bool interrupted() const { return events_.stop && events_.stop(); }

    const ConditionPlan& plan_;
    const ConditionEvents& events_;
    RealtimeLease realtime_;  // nodes hold where the session is silent: other work must not silence it
    ConditionFiles files_;    // has the log, which outlives the sockets
    Sockets sockets_;
    SessionProcess session_;
    SessionAndObserver both_;
    RealtimeLoop loop_;
    ConditionNodes nodes_;
    SessionStop stop_;
    RunOutcome outcome_;
    TrajectorySample last_;
};

// Runs the trials of the plan. Throws Error as ConditionRun does.
ConditionResult run_condition(const ConditionPlan& plan, const ConditionEvents& events);

}  // namespace thimble
