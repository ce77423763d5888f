// The part of a session that changes the network of a running trial.
#include <utility>

#include "netem/profiles/profiles.hpp"
#include "session/run/session_process.hpp"

namespace thimble {
namespace {

WayInShort in_short(const LinkSettings& link) {
    return {to_seconds(link.delay), to_seconds(link.jitter.spread), stationary_loss(link.loss)};
}

}  // namespace

void SessionProcess::change_delay(Duration one_way) {
    if (one_way == settings_.force_delay) return;
    settings_.network_delay += one_way - settings_.force_delay;
    settings_.force_delay = one_way;
    delay_s_ = to_seconds(one_way);
    tell_network();
    if (under_way()) note_network(record_.samples.empty() ? 0 : record_.samples.back().time_s, false);
}

bool SessionProcess::change_network(const NetworkName& name) {
    const LinkProfile* profile = built_in_profile(name.view());
    if (profile == nullptr) return false;
    if (name == network_ && profile->down.delay == settings_.force_delay) return true;
    network_ = name;
    settings_.network_delay = nearly_longest_delay(profile->up) + nearly_longest_delay(profile->down);
    settings_.force_delay = profile->down.delay;
    delay_s_ = to_seconds(settings_.force_delay);
    tell_network();
    if (under_way()) note_network(record_.samples.empty() ? 0 : record_.samples.back().time_s, true);
    return true;
}

void SessionProcess::tell_network() {
    network_changed_ = network_fresh_ = true;
    next_send_ = {};
}

void SessionProcess::note_network(double time_s, bool profile) {
    NetworkEvent event;
    event.time_s = time_s;
    event.delay_s = delay_s_;
    const LinkProfile* chosen = profile ? built_in_profile(network_.view()) : nullptr;
    if (chosen != nullptr) {
        event.profile = chosen->name;
        event.needle = in_short(chosen->up);
        event.force = in_short(chosen->down);
        event.force.delay_s = delay_s_;  // which may have been changed since the profile was chosen
    }
    record_.network_events.push_back(std::move(event));
}

SessionControl SessionProcess::network_order() const {
    SessionControl change = order_;
    change.kind = ControlKind::kNetworkChange;
    change.network = network_;
    change.network_delay_s = delay_s_;
    change.silence_s = to_seconds(settings_.network_delay);  // an answer waits for both ways
    return change;
}

}  // namespace thimble
