// Records a trial: a sample per answer of slave_sim, the beep, the withdrawal after it, the end.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/messages.hpp"
#include "session/records/trial_record.hpp"
#include "session/settings/session_settings.hpp"

namespace thimble {

inline TrajectorySample sample_of(const ForceFeedback& feedback, SessionTime first_echo) {
    TrajectorySample sample;
    sample.time_s = to_seconds(feedback.echo_time - first_echo);
    copy_state(feedback, sample);
    return sample;
}

inline constexpr Duration kWithdrawnFor = std::chrono::milliseconds{300};

class TrialRecorder {
  public:
    // Called for each recorded sample, before it is stored (to write it to disk as it comes).
    using SampleHook = std::function<void(const TrajectorySample&)>;

    explicit TrialRecorder(const SessionSettings& settings)
        : contact_hold_s_(to_seconds(settings.contact_hold)),
          capacity_(static_cast<std::size_t>((settings.trial_timeout + kAfterTimeout) /
                                             std::max(settings.sample_period, Duration{1}))),
          compensator_(settings.compensator) {}

    void set_sample_hook(SampleHook hook) { hook_ = std::move(hook); }

    void begin(const TrialConditions& conditions) {
        record_.conditions = conditions;
        record_.conditions.compensator =
            conditions.modality == Modality::kHF ? compensator_ : Compensator::kNone;
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

    // True if the beep is due with this answer.
    bool add(const Header& header, const ForceFeedback& feedback) {
        newest_ = feedback;
        newest_sent_ = header.send_time;
        heard_ = true;
        if (feedback.needle_held) return false;
        if (record_.samples.empty()) first_echo_ = feedback.echo_time;
        const TrajectorySample sample = sample_of(feedback, first_echo_);
        // A copy of a command whose number has flipped bits is answered again. An earlier time is kept: the one before may be wrong.
        if (!record_.samples.empty() && sample.time_s == record_.samples.back().time_s) return false;
        const bool beeps = beep_is_due(sample);
        watch_withdrawal(sample);
        if (hook_) hook_(sample);
        record_.samples.push_back(sample);
        return beeps;
    }

    void add(const NetworkEvent& event) { record_.network_events.push_back(event); }
    void end(EndReason reason, Role lost_peer, std::string_view fault) {
        record_.reason = reason;
        record_.lost_peer = lost_peer;
        record_.fault = fault;
    }

    void add_round_trip(const Heartbeat& master) {
        record_.round_trip_s = master.round_trip_median_s;
        record_.achieved_delay_s = master.round_trip_median_s - master.hold_median_s;
    }

    const TrialRecord& record() const { return record_; }
    double newest_time_s() const { return record_.samples.empty() ? 0 : record_.samples.back().time_s; }
    // Newest answer of slave_sim in this trial and when it left there, on its clock; null before the first one.
    const ForceFeedback* newest() const { return heard_ ? &newest_ : nullptr; }
    SessionTime newest_sent() const { return newest_sent_; }
    // The needle was free of the tissue for kWithdrawnFor after the beep.
    bool withdrawn() const { return withdrawn_; }

  private:
    // Samples come before the time-out counts: as soon as the master has started.
    static constexpr Duration kAfterTimeout = std::chrono::seconds{1};

    bool beep_is_due(const TrajectorySample& sample) {
        if (!std::isnan(record_.beep_time_s) || sample.contact_time_s < contact_hold_s_) return false;
        record_.beep_time_s = sample.time_s;
        return true;
    }

    // A while, not one sample: the record may return to `free` for an instant (docs/model.md).
    void watch_withdrawal(const TrajectorySample& sample) {
        if (std::isnan(record_.beep_time_s) || sample.phase != TissuePhase::kFree) {
            free_since_s_ = std::nan("");
            return;
        }
        if (std::isnan(free_since_s_)) free_since_s_ = sample.time_s;
        withdrawn_ = sample.time_s - free_since_s_ >= to_seconds(kWithdrawnFor);
    }

    double contact_hold_s_;
    std::size_t capacity_;  // samples of the longest trial
    Compensator compensator_;
    SampleHook hook_;
    TrialRecord record_;
    SessionTime first_echo_{};
    ForceFeedback newest_;
    SessionTime newest_sent_{};
    bool heard_ = false;
    double free_since_s_ = 0;  // after the beep, in the record's time; NaN: in touch with the tissue
    bool withdrawn_ = false;
};

}  // namespace thimble
