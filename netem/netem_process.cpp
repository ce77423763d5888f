#include "netem/netem_process.hpp"

#include <algorithm>

#include "netem/profiles/profiles.hpp"

namespace thimble {
NetemProcess::NetemProcess(std::uint64_t instance, const NetemSettings& s, Ports& ports)
    : NodeProcess(Role::kNetem, instance, *ports.between(Port::kNetemControl, Port::kSessionNetem)) {
    const auto add = [&](Port in, Port out, Direction direction) {
        const bool up = direction == kDirectionNeedle;
        Channel* const from = ports.inlet(in);
        relays_.emplace_back(from, ports.outlet(out), up ? s.needle : s.force, direction,
                             up ? s.needle_timeline : s.force_timeline);
    };
    add(Port::kNetemNeedle, Port::kSlaveNeedle, kDirectionNeedle);
    add(Port::kNetemForceMaster, Port::kMasterForce, kDirectionForceMaster);
    add(Port::kNetemForceCutaneous, Port::kCutaneousForce, kDirectionForceCutaneous);
    add(Port::kNetemForceVisual, Port::kVisualForce, kDirectionForceVisual);
    join_stop_bus(ports);
}

void NetemProcess::begin_trial(SessionTime now, const SessionControl& control) {
    for (Relay& relay : relays_) {
        relay.before += relay.model.counters();
        if (relay.changed) relay.model.change(now, relay.start);
        relay.model.restart({control.study_seed, control.experiment, control.subject, trial()}, now);
    }
}

void NetemProcess::network_changed(SessionTime now, const SessionControl& control) {
    for (Relay& relay : relays_) change(now, relay, control);
}

void NetemProcess::change(SessionTime now, Relay& relay, const SessionControl& control) {
    LinkSettings settings = relay.model.settings();
    const LinkProfile* profile =
        control.network == relay.network ? nullptr : built_in_profile(control.network.view());
    if (profile != nullptr) {
        relay.network = control.network;
        relay.start = settings = relay.delayed ? profile->down : profile->up;
    }
    if (relay.delayed) relay.start.delay = settings.delay = from_seconds(control.network_delay_s);
    if (profile == nullptr && !relay.delayed) return;
    relay.changed = true;
    relay.model.change(now, settings);
}

void NetemProcess::work(SessionTime now) {
    for (Relay& relay : relays_) {
        send_due(now, relay);  // first what is late already
        bool arrived = false;
        for (int taken = 0; taken < kMostRefusedAtOnce; ++taken) {
            const Bytes in = relay.from->receive();
            if (in.empty()) break;
            relay.model.push(now, in);
            arrived = true;
        }
        if (arrived) send_due(now, relay);
    }
}

void NetemProcess::send_due(SessionTime now, Relay& relay) {
    for (Bytes out = relay.model.pop_due(now); !out.empty(); out = relay.model.pop_due(now))
        relay.to->send(out);
}

SessionTime NetemProcess::next_work() const {
    SessionTime next = kNever;
    for (const Relay& relay : relays_) next = std::min(next, relay.model.next_due());
    return next;
}

}  // namespace thimble
