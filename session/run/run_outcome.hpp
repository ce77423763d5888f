// How a condition's run has gone so far: what each trial's end means for the whole run, and the words for it.
#pragma once

#include <string>
#include <string_view>

#include "session/run/condition_files.hpp"
#include "session/run/condition_nodes.hpp"
#include "session/run/session_stop.hpp"

namespace thimble {

class RunOutcome {
  public:
    // All outlive this.
    RunOutcome(const ConditionFiles& files, ConditionNodes& nodes, const SessionStop& stop)
        : files_(files), nodes_(nodes), stop_(stop) {}

    // A trial begins: a stop that has been released is forgotten.
    void begin_trial();
    // `interrupted`: by this program's user. If an observer has ended the trial, the run goes on.
    void judge(const TrialRecord& record, bool interrupted);
    // Also where a trial had ended well before: nothing is missing without a word. Empty words change nothing.
    void add_write_fault(std::string_view words);
    // A stop that holds at the end of the run.
    void add_last_stop();
    void forget();

    bool failed() const { return result_.code != ExitCode::kOk; }
    bool halted() const { return halted_; }  // by a stop, which the result names until the next trial
    ConditionResult& result() { return result_; }
    const ConditionResult& result() const { return result_; }

  private:
    void fail(ExitCode code, const std::string& problem);
    std::string fault_text(const TrialRecord& record) const;

    const ConditionFiles& files_;
    ConditionNodes& nodes_;
    const SessionStop& stop_;
    ConditionResult result_;
    bool halted_ = false;
};

}  // namespace thimble
