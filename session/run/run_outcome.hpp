// How a condition's run has gone so far: what each trial's end means for the whole run, and the words for it.
#pragma once

#include <string>
#include <string_view>

#include <fmt/format.h>

#include "session/records/trial_table.hpp"
#include "session/run/condition_files.hpp"
#include "session/run/condition_nodes.hpp"
#include "session/run/node_peers.hpp"
#include "session/run/session_stop.hpp"

namespace thimble {

class RunOutcome {
  public:
    // All outlive this.
    RunOutcome(const ConditionFiles& files, ConditionNodes& nodes, const SessionStop& stop)
        : files_(files), nodes_(nodes), stop_(stop) {}

    // A trial begins: a stop that has been released is forgotten.
    void begin_trial() {
        if (halted_) forget();
    }

    // `interrupted`: by this program's user. If an observer has ended the trial, the run goes on.
    void judge(const TrialRecord& record, bool interrupted) {
        if (record.reason == EndReason::kInterrupted && interrupted) {
            fail(ExitCode::kRunFailed, "interrupted; finished trials are kept");
        } else if (is_stop(record.reason)) {
            halted_ = true;
            fail(ExitCode::kRunFailed,
                 fmt::format("{}: {}; {}", outcome_text(record.reason, record.lost_peer), record.fault,
                             stop_.how_to_release()));
        } else if (record.reason == EndReason::kDeviceFault) {
            fail(ExitCode::kRunFailed, fault_text(record));
        } else if (record.reason == EndReason::kPeerLost) {
            const bool gave_up = record.fault.find(kGaveUp) != std::string::npos;
            const bool plugin = record.conditions.compensator == Compensator::kPlugin;
            const auto dead = nodes_.dead_soon(plugin ? kLastWordsOfPlugin : kLastWords);
            fail(dead ? nodes_.verdict(*dead) : ExitCode::kNetwork,
                 dead      ? nodes_.exit_message(*dead)
                 : gave_up ? record.fault
                           : fmt::format("lost contact with {}: {}; {}", to_string(record.lost_peer),
                                         record.fault, nodes_.advice_on_silence()));
        }
        add_write_fault(files_.fault());
    }

    // Nodes that ran already have the network of their own file, which is to be this one. It is another if forces are quicker.
    // Names no delay: the experimenter may be blinded.
    void judge_delay(const TrialRecord& record, Duration least) {
        const double bound_s = 0.99 * to_seconds(least) - 1e-3;  // the median is that of a histogram
        const bool measured = record.round_trip_s > 0 && record.network_events.empty();
        if (failed() || !measured || record.achieved_delay_s >= bound_s) return;
        fail(ExitCode::kUsage,
             "forces came back sooner than this session file allows: the running thimble-netem has another "
             "[netem.force] delay_s. Give both the same file, and start thimble-netem anew");
    }

    // Reported also if the trial had ended well before: missing data need a message. Empty words change nothing.
    void add_write_fault(std::string_view words) {
        if (words.empty()) return;
        if (result_.write_fault.empty()) result_.write_fault = printable(std::string(words));
        if (!failed()) fail(ExitCode::kRunFailed, std::string(words));
    }

    // A stop that holds at the end of the run.
    void add_last_stop() {
        if (stop_.stopped() && !failed()) fail(ExitCode::kRunFailed, stop_.words());
    }

    void forget() {
        result_ = {};
        halted_ = false;
    }

    bool failed() const { return result_.code != ExitCode::kOk; }
    bool halted() const { return halted_; }  // by a stop, which the result names until the next trial
    ConditionResult& result() { return result_; }
    const ConditionResult& result() const { return result_; }

  private:
    // Shorter than kPeerTimeout, so that the other nodes do not miss the session. On a busy machine a master needs longer to name the
    // plug-in that hangs, and to end.
    static constexpr Duration kLastWords = std::chrono::milliseconds{300};
    static constexpr Duration kLastWordsOfPlugin = std::chrono::seconds{2};

    void fail(ExitCode code, const std::string& problem) {
        result_.code = code;
        result_.problem = printable(problem);  // it may quote any peer
    }

    // A file that cannot be written ends the trial as a failed device does.
    std::string fault_text(const TrialRecord& record) const {
        if (record.lost_peer == Role::kSession && !files_.fault().empty()) return files_.fault();
        if (record.lost_peer == Role::kSession && files_.log() != nullptr) return files_.log_fault();
        if (record.fault.starts_with("the log "))
            return fmt::format("{}: {}", to_string(record.lost_peer), record.fault);
        return fmt::format("the device of {} failed: {}", to_string(record.lost_peer), record.fault);
    }

    const ConditionFiles& files_;
    ConditionNodes& nodes_;
    const SessionStop& stop_;
    ConditionResult result_;
    bool halted_ = false;
};

}  // namespace thimble
