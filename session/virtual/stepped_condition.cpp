#include "session/virtual/stepped_condition.hpp"

#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"
#include "session/records/trial_table.hpp"
#include "session/run/condition_files.hpp"
#include "session/run/session_stop.hpp"

namespace thimble {
namespace {

constexpr unsigned kLookEvery = 64;  // instants: to look around costs more than one
constexpr Duration kProgressPeriod = std::chrono::milliseconds{500};
constexpr Duration kViewPeriod = std::chrono::milliseconds{4};  // several per frame of a screen

// The observer of a condition. Its sockets are its own: the conductor counts none of their datagrams. Its clock
// goes on from trial to trial, so a view hears one session. It speaks no more often than by the wall clock.
class Watch {
  public:
    explicit Watch(const ConditionPlan& plan) : plan_(plan) {
        if (plan.make_observer) sockets_.emplace(plan.network);
    }

    void begin_trial(SteppedSession& stepped) {
        if (!sockets_) return;
        stepped_ = &stepped;
        if (!observer_) observer_ = plan_.make_observer(stepped.session(), *sockets_, plan_.name);
        observer_->serve(stepped.session(), ahead_);
    }
    void look(SessionTime by_wall) {
        if (!sockets_ || by_wall < next_) return;
        next_ = by_wall + kViewPeriod;
        speak(by_wall);
    }
    // All is said once more: a view sees how the trial ended.
    void end_trial() {
        if (!sockets_) return;
        ahead_ += kViewPeriod;
        observer_->serve(stepped_->session(), ahead_);
        speak(wall_now());
        ahead_ += stepped_->now() - SessionTime{};
    }

  private:
    void speak(SessionTime by_wall) {
        sockets_->tick(by_wall);
        observer_->tick(stepped_->now() + ahead_);
        sockets_->tick(by_wall);
    }

    const ConditionPlan& plan_;
    std::optional<Sockets> sockets_;  // none: no observer
    SteppedSession* stepped_ = nullptr;
    std::unique_ptr<Observer> observer_;
    Duration ahead_{};
    SessionTime next_{};
};

class SteppedCondition {
  public:
    SteppedCondition(const ConditionPlan& plan, const ConditionEvents& events)
        : plan_(plan), events_(events), files_(plan, false), watch_(plan) {}

    void run_trial(SteppedSession& stepped, const TrialConditions& trial) {
        SessionProcess& session = stepped.session();
        files_.begin_trial(trial, trial.trial,
                           plan_.out.parent_path() / "trajectories" / trajectory_name(trial));
        session.set_sample_hook([this](const TrajectorySample& sample) {
            last_ = sample;
            files_.add(sample);
        });
        stepped.start(trial);
        watch_.begin_trial(stepped);
        const SessionTime begin = stepped.now();
        for (unsigned instant = 0; stepped.step(); ++instant) {
            if (instant % kLookEvery == 0) look_around(stepped, trial);
            if (stepped.lost() && !std::exchange(told_lost_, true))
                session.abort(interrupted() ? EndReason::kInterrupted : EndReason::kPeerLost,
                              stepped.lost()->role);
        }
        result_.simulated_s += to_seconds(stepped.now() - begin);
        watch_.end_trial();
        files_.end_trial(session.record());
        judge(stepped);
        if (events_.trial_done) events_.trial_done(session.record());
    }

    ConditionResult& result() { return result_; }

  private:
    bool interrupted() const { return events_.stop && events_.stop(); }

    void look_around(SteppedSession& stepped, const TrialConditions& trial) {
        SessionProcess& session = stepped.session();
        if (interrupted()) return session.abort(EndReason::kInterrupted);
        if (emergency_stops() != stop_keys_)
            session.emergency_stop(stepped.now(), "Ctrl-\\ in the terminal of thimble");
        stop_keys_ = keys_carried_out = emergency_stops();
        stepped.look_outside();
        if (!fault(stepped).empty()) return session.abort(EndReason::kDeviceFault, Role::kSession);
        const SessionTime now = wall_now();
        watch_.look(now);
        if (now < next_progress_ || !events_.progress) return;
        next_progress_ = now + kProgressPeriod;
        files_.flush();
        events_.progress(trial, last_);
    }

    std::string fault(const SteppedSession& stepped) const {
        return files_.fault().empty() ? stepped.fault() : files_.fault();
    }

    void judge(SteppedSession& stepped) {
        const TrialRecord& record = stepped.session().record();
        const std::optional<LostNode>& lost = stepped.lost();
        const std::string outcome = outcome_text(record.reason, record.lost_peer);
        if (record.reason == EndReason::kInterrupted && interrupted()) {
            fail(ExitCode::kRunFailed, "interrupted; finished trials are kept");
        } else if (const std::string words = fault(stepped); !words.empty()) {
            fail(ExitCode::kRunFailed, words);
        } else if (is_stop(record.reason) || record.reason == EndReason::kDeviceFault) {
            fail(ExitCode::kRunFailed, fmt::format("{}: {}", outcome, record.fault));
        } else if (record.reason == EndReason::kPeerLost) {
            fail(lost ? lost->code : ExitCode::kNetwork, lost ? lost->words : outcome);
        }
    }

    void fail(ExitCode code, const std::string& problem) {
        result_.code = code;
        result_.problem = problem;
    }

    const ConditionPlan& plan_;
    const ConditionEvents& events_;
    ConditionFiles files_;
    Watch watch_;
    ConditionResult result_;
    TrajectorySample last_;
    SessionTime next_progress_{};
    bool told_lost_ = false;
    unsigned stop_keys_ =
        keys_carried_out;  // a key pressed while the programs start counts for the first trial
};

}  // namespace

ConditionResult run_stepped_condition(const ConditionPlan& plan, const ConditionEvents& events,
                                      const MakeSteppedSession& make) {
    SteppedCondition condition(plan, events);
    for (const TrialConditions& trial : plan.trials) {
        condition.run_trial(*make(), trial);
        if (condition.result().code != ExitCode::kOk) break;
    }
    return std::move(condition.result());
}

}  // namespace thimble
