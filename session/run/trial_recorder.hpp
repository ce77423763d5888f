// Records a trial: a sample per answer of slave_sim, the beep, the withdrawal after it, the end.
#pragma once

#include <functional>

#include "common/messages.hpp"
#include "session/records/trial_record.hpp"
#include "session/settings/session_settings.hpp"

namespace thimble {

inline constexpr Duration kWithdrawnFor = std::chrono::milliseconds{300};

class TrialRecorder {
  public:
    // Called for each recorded sample, before it is stored (to write it to disk as it comes).
    using SampleHook = std::function<void(const TrajectorySample&)>;

    explicit TrialRecorder(const SessionSettings& settings);
    void set_sample_hook(SampleHook hook) { hook_ = std::move(hook); }

    void begin(const TrialConditions& conditions);
    // True if the beep is due with this answer.
    bool add(const Header& header, const ForceFeedback& feedback);
    void add(const NetworkEvent& event) { record_.network_events.push_back(event); }
    void end(EndReason reason, Role lost_peer, std::string_view fault);
    void add_round_trip(const Heartbeat& master);

    const TrialRecord& record() const { return record_; }
    double newest_time_s() const { return record_.samples.empty() ? 0 : record_.samples.back().time_s; }
    // Newest answer of slave_sim in this trial and when it left there, on its clock; null before the first one.
    const ForceFeedback* newest() const { return heard_ ? &newest_ : nullptr; }
    SessionTime newest_sent() const { return newest_sent_; }
    // The needle was free of the tissue for kWithdrawnFor after the beep.
    bool withdrawn() const { return withdrawn_; }

  private:
    bool beep_is_due(const TrajectorySample& sample);
    void watch_withdrawal(const TrajectorySample& sample);

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
