#include "session/run/trial_recorder.hpp"

#include <algorithm>
#include <cmath>

namespace thimble {
namespace {

// Samples still come until all nodes have heard of the end.
constexpr Duration kAfterTimeout = std::chrono::seconds{1};

TrajectorySample sample_of(const ForceFeedback& feedback, SessionTime first_echo) {
    TrajectorySample sample;
    sample.time_s = to_seconds(feedback.echo_time - first_echo);
    copy_state(feedback, sample);
    return sample;
}

}  // namespace

TrialRecorder::TrialRecorder(const SessionSettings& settings)
    : contact_hold_s_(to_seconds(settings.contact_hold)),
      capacity_(static_cast<std::size_t>((settings.trial_timeout + kAfterTimeout) /
                                         std::max(settings.sample_period, Duration{1}))),
      compensator_(settings.compensator) {}

void TrialRecorder::begin(const TrialConditions& conditions) {
    record_.conditions = conditions;
    record_.conditions.compensator = conditions.modality == Modality::kHF ? compensator_ : Compensator::kNone;
    record_.samples.clear();
    record_.samples.reserve(capacity_);
    record_.network_events.clear();
    record_.beep_time_s = record_.round_trip_s = record_.achieved_delay_s = std::nan("");
    record_.reason = EndReason::kNone;
    record_.lost_peer = Role::kSession;
    record_.fault.clear();
    heard_ = false;
    free_since_s_ = std::nan("");
    withdrawn_ = false;
}

bool TrialRecorder::add(const Header& header, const ForceFeedback& feedback) {
    newest_ = feedback;
    newest_sent_ = header.send_time;
    heard_ = true;
    if (feedback.needle_held) return false;
    if (record_.samples.empty()) first_echo_ = feedback.echo_time;
    const TrajectorySample sample = sample_of(feedback, first_echo_);
    const bool beeps = beep_is_due(sample);
    watch_withdrawal(sample);
    if (hook_) hook_(sample);
    record_.samples.push_back(sample);
    return beeps;
}

bool TrialRecorder::beep_is_due(const TrajectorySample& sample) {
    if (!std::isnan(record_.beep_time_s) || sample.contact_time_s < contact_hold_s_) return false;
    record_.beep_time_s = sample.time_s;
    return true;
}

// A while, not one sample: the record may return to `free` for an instant (docs/model.md).
void TrialRecorder::watch_withdrawal(const TrajectorySample& sample) {
    if (std::isnan(record_.beep_time_s) || sample.phase != TissuePhase::kFree) {
        free_since_s_ = std::nan("");
        return;
    }
    if (std::isnan(free_since_s_)) free_since_s_ = sample.time_s;
    withdrawn_ = sample.time_s - free_since_s_ >= to_seconds(kWithdrawnFor);
}

void TrialRecorder::end(EndReason reason, Role lost_peer, std::string_view fault) {
    record_.reason = reason;
    record_.lost_peer = lost_peer;
    record_.fault = fault;
}

void TrialRecorder::add_round_trip(const Heartbeat& master) {
    record_.round_trip_s = master.round_trip_median_s;
    record_.achieved_delay_s = master.round_trip_median_s - master.hold_median_s;
}

}  // namespace thimble
