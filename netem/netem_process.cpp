#include "netem/netem_process.hpp"

#include <algorithm>

#include "netem/profiles/profiles.hpp"

namespace thimble {
namespace {

std::vector<RelayPlan> plans_of(const NetemSettings& s, Ports& ports) {
    std::vector<RelayPlan> plans;
    const auto add = [&](Port in, Port out, const LinkSettings& link, Direction direction,
                         const Timeline& timeline) {
        Channel* const from = ports.inlet(in);
        plans.push_back({from, ports.outlet(out), link, direction, timeline});
    };
    add(Port::kNetemNeedle, Port::kSlaveNeedle, s.needle, kDirectionNeedle, s.needle_timeline);
    add(Port::kNetemForceMaster, Port::kMasterForce, s.force, kDirectionForceMaster, s.force_timeline);
    add(Port::kNetemForceCutaneous, Port::kCutaneousForce, s.force, kDirectionForceCutaneous,
        s.force_timeline);
    add(Port::kNetemForceVisual, Port::kVisualForce, s.force, kDirectionForceVisual, s.force_timeline);
    return plans;
}

}  // namespace

NetemProcess::NetemProcess(std::uint64_t instance, Channel& control, const std::vector<RelayPlan>& plans)
    : NodeProcess(Role::kNetem, instance, control), relays_(plans.begin(), plans.end()) {}

NetemProcess::NetemProcess(std::uint64_t instance, const NetemSettings& settings, Ports& ports)
    : NetemProcess{instance, *ports.between(Port::kNetemControl, Port::kSessionNetem),
                   plans_of(settings, ports)} {
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
