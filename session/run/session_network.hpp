// The network of a session as it was last asked for: another delay of the force path, or a profile for both ways.
#pragma once

#include "common/messages.hpp"
#include "netem/profiles/profiles.hpp"
#include "session/records/trial_record.hpp"
#include "session/settings/session_settings.hpp"

namespace thimble {

inline WayInShort in_short(const LinkSettings& link) {
    return {to_seconds(link.delay), to_seconds(link.jitter.spread), stationary_loss(link.loss)};
}

class SessionNetwork {
  public:
    explicit SessionNetwork(const SessionSettings& settings)
        : both_ways_(settings.network_delay), force_delay_(settings.force_delay) {}

    double force_delay_s() const { return to_seconds(force_delay_); }  // one way
    Duration both_ways() const { return both_ways_; }  // needle and force path, jitter included
    const NetworkName& name() const { return name_; }  // empty: the settings' own

    // False if nothing changes.
    bool change_delay(Duration one_way) {
        if (one_way == force_delay_) return false;
        both_ways_ += one_way - force_delay_;
        force_delay_ = one_way;
        return true;
    }

    // `name` is that of a profile that comes with the program.
    bool change_profile(const NetworkName& name) {
        const LinkProfile& profile = *built_in_profile(name.view());
        if (name == name_ && profile.down.delay == force_delay_) return false;
        name_ = name;
        both_ways_ = nearly_longest_delay(profile.up) + nearly_longest_delay(profile.down);
        force_delay_ = profile.down.delay;
        return true;
    }

    // For a record: the profile with its delay as it is now, or the delay alone.
    NetworkEvent event(double time_s, bool with_profile) const {
        NetworkEvent event;
        event.time_s = time_s;
        event.delay_s = force_delay_s();
        const LinkProfile* profile = with_profile ? built_in_profile(name_.view()) : nullptr;
        if (profile == nullptr) return event;
        event.profile = profile->name;
        event.needle = in_short(profile->up);
        event.force = in_short(profile->down);
        event.force.delay_s = event.delay_s;  // which may have been changed since the profile was chosen
        return event;
    }

    // `order` with kind and values of a NetworkChange.
    SessionControl order(SessionControl order) const {
        order.kind = ControlKind::kNetworkChange;
        order.network = name_;
        order.network_delay_s = force_delay_s();
        order.silence_s = to_seconds(both_ways_);  // an answer waits for both ways
        return order;
    }

  private:
    Duration both_ways_, force_delay_;
    NetworkName name_;
};

}  // namespace thimble
