#include "session/run/run_outcome.hpp"

#include <fmt/format.h>

#include "session/records/trial_table.hpp"

namespace thimble {

void RunOutcome::begin_trial() {
    if (halted_) forget();
}

void RunOutcome::forget() {
    result_ = {};
    halted_ = false;
}

void RunOutcome::judge(const TrialRecord& record, bool interrupted) {
    if (record.reason == EndReason::kInterrupted && interrupted) {
        fail(ExitCode::kRunFailed, "interrupted; what was recorded is kept");
    } else if (is_stop(record.reason)) {
        halted_ = true;
        fail(ExitCode::kRunFailed, fmt::format("{}: {}; {}", outcome_text(record.reason, record.lost_peer),
                                               record.fault, stop_.how_to_release()));
    } else if (record.reason == EndReason::kDeviceFault) {
        fail(ExitCode::kRunFailed, fault_text(record));
    } else if (record.reason == EndReason::kPeerLost) {
        const auto dead = nodes_.dead();
        fail(ExitCode::kNetwork, dead ? nodes_.exit_message(*dead)
                                      : fmt::format("lost contact with {}", to_string(record.lost_peer)));
    }
    add_write_fault(files_.fault());
}

// A file that cannot be written ends the trial as a failed device does.
std::string RunOutcome::fault_text(const TrialRecord& record) const {
    if (record.lost_peer == Role::kSession && !files_.fault().empty()) return files_.fault();
    if (record.lost_peer == Role::kSession && files_.log() != nullptr) return files_.log_fault();
    if (record.fault.starts_with("the log "))
        return fmt::format("{}: {}", to_string(record.lost_peer), record.fault);
    return fmt::format("the device of {} failed: {}", to_string(record.lost_peer), record.fault);
}

void RunOutcome::add_write_fault(std::string_view words) {
    if (!words.empty() && !failed()) fail(ExitCode::kRunFailed, std::string(words));
}

void RunOutcome::add_last_stop() {
    if (stop_.stopped() && !failed()) fail(ExitCode::kRunFailed, stop_.words());
}

void RunOutcome::fail(ExitCode code, const std::string& problem) {
    result_.code = code;
    result_.problem = problem;
}

}  // namespace thimble
