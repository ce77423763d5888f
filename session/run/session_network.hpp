// The network of a session as it was last asked for: another delay of the force path, or a profile for both ways.
#pragma once

#include "common/messages.hpp"
#include "session/records/trial_record.hpp"
#include "session/settings/session_settings.hpp"

namespace thimble {

class SessionNetwork {
  public:
    explicit SessionNetwork(const SessionSettings& settings)
        : both_ways_(settings.network_delay), force_delay_(settings.force_delay) {}

    double force_delay_s() const { return to_seconds(force_delay_); }  // one way
    Duration both_ways() const { return both_ways_; }  // needle and force path, jitter included
    const NetworkName& name() const { return name_; }  // empty: the settings' own

    // False: it is so already.
    bool change_delay(Duration one_way);
    // `name` is that of a profile that comes with the program.
    bool change_profile(const NetworkName& name);

    // For a record: the profile with its delay as it is now, or the delay alone.
    NetworkEvent event(double time_s, bool with_profile) const;
    // `order` with kind and values of a NetworkChange.
    SessionControl order(SessionControl order) const;

  private:
    Duration both_ways_, force_delay_;
    NetworkName name_;
};

}  // namespace thimble
