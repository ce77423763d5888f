#include "session/virtual/stepped_condition.hpp"

#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"
#include "session/records/trial_table.hpp"
#include "session/run/condition_files.hpp"

namespace thimble {
namespace {

constexpr unsigned kLookEvery = 64;  // instants: to look around costs more than one
constexpr Duration kProgressPeriod = std::chrono::milliseconds{500};

class SteppedCondition {
  public:
    SteppedCondition(const ConditionPlan& plan, const ConditionEvents& events)
        : plan_(plan), events_(events), files_(plan, false) {}

    void run_trial(SteppedSession& stepped, const TrialConditions& trial) {
        SessionProcess& session = stepped.session();
        files_.begin_trial(trial, trial.trial,
                           plan_.out.parent_path() / "trajectories" / trajectory_name(trial));
        session.set_sample_hook([this](const TrajectorySample& sample) {
            last_ = sample;
            files_.add(sample);
        });
        stepped.start(trial);
        const SessionTime begin = stepped.now();
        for (unsigned instant = 0; stepped.step(); ++instant) {
            if (instant % kLookEvery == 0) look_around(stepped, trial);
            if (stepped.lost() && !std::exchange(told_lost_, true))
                session.abort(interrupted() ? EndReason::kInterrupted : EndReason::kPeerLost,
                              stepped.lost()->role);
        }
        result_.simulated_s += to_seconds(stepped.now() - begin);
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
            session.emergency_stop(stepped.now(), "Ctrl-\\ at thimble's terminal");
        stop_keys_ = emergency_stops();
        stepped.look_outside();
        if (!fault(stepped).empty()) return session.abort(EndReason::kDeviceFault, Role::kSession);
        const SessionTime now = wall_now();
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
            fail(ExitCode::kRunFailed, "interrupted; what was recorded is kept");
        } else if (const std::string words = fault(stepped); !words.empty()) {
            fail(ExitCode::kRunFailed, words);
        } else if (is_stop(record.reason) || record.reason == EndReason::kDeviceFault) {
            fail(ExitCode::kRunFailed, fmt::format("{}: {}", outcome, record.fault));
        } else if (record.reason == EndReason::kPeerLost) {
            fail(ExitCode::kNetwork, lost ? lost->words : outcome);
        }
    }

    void fail(ExitCode code, const std::string& problem) {
        result_.code = code;
        result_.problem = problem;
    }

    const ConditionPlan& plan_;
    const ConditionEvents& events_;
    ConditionFiles files_;
    ConditionResult result_;
    TrajectorySample last_;
    SessionTime next_progress_{};
    bool told_lost_ = false;
    unsigned stop_keys_ = emergency_stops();  // carried out
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
