// The relay: one directed link per flow; all delay of the system is in its LinkModels. It forwards datagrams and
// never looks inside them. In virtual time, a link that only delays stores the address of a shared message instead of
// its bytes.
#pragma once

#include <algorithm>
#include <cstring>
#include <vector>

#include "common/node_process.hpp"
#include "common/shared_message.hpp"
#include "netem/link_model.hpp"
#include "netem/netem_settings.hpp"
#include "netem/profiles/profiles.hpp"

namespace thimble {

// A datagram from `from` leaves at `to`, later.
struct Relay {
    Relay(Channel* in, Channel* out, const LinkSettings& link, Direction direction, const Timeline& timeline)
        : from(in),
          to(out),
          delayed(direction != kDirectionNeedle),
          start(link),
          model(link, StreamKey{}, direction, timeline) {}

    Channel* from;
    Channel* to;
    bool delayed;  // on the force path, whose delay may be changed alone
    bool changed = false;
    LinkSettings start;   // what each trial begins with
    NetworkName network;  // the profile that holds; empty: the link of the session file
    LinkModel model;
    LinkCounters before;  // of the trials before this one: the model starts anew with each
};

class NetemProcess final : public NodeProcess {
  public:
    // Opens its channels: the needle's link and three for the force.
    NetemProcess(std::uint64_t instance, const NetemSettings& s, Ports& ports)
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

    const std::vector<Relay>& relays() const { return relays_; }

  protected:
    void begin_trial(SessionTime now, const SessionControl& control) override {
        for (Relay& relay : relays_) {
            relay.before += relay.model.counters();
            if (relay.changed) relay.model.change(now, relay.start);
            while (Packet* packet = relay.model.forget_any()) release(relay, *packet);
            relay.model.restart({control.study_seed, control.experiment, control.subject, trial()}, now);
        }
    }

    void end_trial(SessionTime /*now*/) override {}  // what is in flight still arrives, as in a real network
    // A profile's two ways, by its name among those that come with the program, and the force path's delay. Packets in
    // flight keep their fate. On a link in order none overtakes them: after a shorter delay the new packets wait for the
    // old ones. Where the profile stays, so do all settings but the delay. The next trial begins with the same. An
    // unknown name changes the delay alone.
    void network_changed(SessionTime now, const SessionControl& control) override {
        for (Relay& relay : relays_) change(now, relay, control);
    }

    void work(SessionTime now) override {
        for (Relay& relay : relays_) {
            if (relay.from->known_empty() && now < relay.model.next_due()) continue;
            send_due(now, relay);  // first what is late already
            bool arrived = false;
            for (int taken = 0; taken < kMostRefusedAtOnce; ++taken) {
                if (!take(now, relay)) break;
                arrived = true;
            }
            if (arrived) send_due(now, relay);
        }
    }

    SessionTime next_work() const override {
        SessionTime next = kNever;
        for (const Relay& relay : relays_) next = std::min(next, relay.model.next_due());
        return next;
    }

  private:
    // Marks a packet that holds the address of a message. Stored as traffic class, with no bit of ECN.
    static constexpr std::uint8_t kHandedOver = 4;

    static bool take(SessionTime now, Relay& relay) {
        if (SharedMessage* const shared = relay.from->receive_shared()) {
            take(now, relay, *shared);
            return true;
        }
        const Bytes in = relay.from->receive();
        if (!in.empty()) relay.model.push(now, in);
        return !in.empty();
    }

    static void take(SessionTime now, Relay& relay, SharedMessage& shared) {
        if (relay.model.passes(now)) return pass_on(relay, shared);
        if (!relay.model.only_delays(now)) return relay.model.push(now, relay.from->pool()->bytes_of(shared));
        const SharedMessage* const address = &shared;
        ++shared.users;
        relay.model.push(now, {reinterpret_cast<const std::uint8_t*>(&address), sizeof(void*)}, kHandedOver);
    }

    static void send_due(SessionTime now, Relay& relay) {
        while (Packet* packet = relay.model.pop_packet(now)) {
            if (packet->traffic_class == kHandedOver) {
                pass_on(relay, message_in(*packet));
                release(relay, *packet);
            } else {
                relay.to->send(packet->bytes());
            }
        }
    }

    static SharedMessage& message_in(Packet& packet) {
        SharedMessage* shared = nullptr;
        std::memcpy(&shared, packet.data(), sizeof(void*));
        return *shared;
    }

    static void pass_on(Relay& relay, SharedMessage& shared) {
        if (relay.to->pool() != nullptr) {
            relay.to->hand_over(shared);
        } else {
            relay.to->send(relay.from->pool()->bytes_of(shared));
        }
    }

    static void release(Relay& relay, Packet& packet) {
        if (packet.traffic_class == kHandedOver) relay.from->pool()->release(message_in(packet));
    }

    static void change(SessionTime now, Relay& relay, const SessionControl& control) {
        LinkSettings settings = relay.model.settings();
        const LinkProfile* profile =
            control.network == relay.network ? nullptr : built_in_profile(control.network.view());
        if (profile != nullptr) {
            relay.network = control.network;
            relay.start = settings = relay.delayed ? profile->down : profile->up;
        }
        if (relay.delayed) {
            for (LinkSettings* one : {&relay.start, &settings})
                set_delay(*one, from_seconds(control.network_delay_s));
        }
        if (profile == nullptr && !relay.delayed) return;
        relay.changed = true;
        relay.model.change(now, settings);
    }

    std::vector<Relay> relays_;
};

}  // namespace thimble
