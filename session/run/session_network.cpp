#include "session/run/session_network.hpp"

#include "netem/profiles/profiles.hpp"

namespace thimble {
namespace {

WayInShort in_short(const LinkSettings& link) {
    return {to_seconds(link.delay), to_seconds(link.jitter.spread), stationary_loss(link.loss)};
}

}  // namespace

bool SessionNetwork::change_delay(Duration one_way) {
    if (one_way == force_delay_) return false;
    both_ways_ += one_way - force_delay_;
    force_delay_ = one_way;
    return true;
}

bool SessionNetwork::change_profile(const NetworkName& name) {
    const LinkProfile& profile = *built_in_profile(name.view());
    if (name == name_ && profile.down.delay == force_delay_) return false;
    name_ = name;
    both_ways_ = nearly_longest_delay(profile.up) + nearly_longest_delay(profile.down);
    force_delay_ = profile.down.delay;
    return true;
}

NetworkEvent SessionNetwork::event(double time_s, bool with_profile) const {
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

SessionControl SessionNetwork::order(SessionControl order) const {
    order.kind = ControlKind::kNetworkChange;
    order.network = name_;
    order.network_delay_s = force_delay_s();
    order.silence_s = to_seconds(both_ways_);  // an answer waits for both ways
    return order;
}

}  // namespace thimble
