// The relay: one directed link per flow, all delay of the system in its LinkModels. It forwards bytes and
// never looks inside them.
#pragma once

#include <vector>

#include "common/node_process.hpp"
#include "netem/link_model.hpp"
#include "netem/netem_settings.hpp"

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
    NetemProcess(std::uint64_t instance, const NetemSettings& settings, Ports& ports);

    const std::vector<Relay>& relays() const { return relays_; }

  protected:
    void begin_trial(SessionTime now, const SessionControl& control) override;
    void end_trial(SessionTime /*now*/) override {}  // what is in flight still arrives, as in a real network
    // A profile's two ways, by its name among those that come with the program, and the force path's delay. Packets in
    // flight keep their fate. On a link in order none overtakes them: after a shorter delay the new packets wait for the
    // old ones. Where the profile stays, so do all settings but the delay. The next trial begins with the same. An
    // unknown name changes the delay alone.
    void network_changed(SessionTime now, const SessionControl& control) override;
    void work(SessionTime now) override;
    SessionTime next_work() const override;

  private:
    static void send_due(SessionTime now, Relay& relay);
    static void change(SessionTime now, Relay& relay, const SessionControl& control);

    std::vector<Relay> relays_;
};

}  // namespace thimble
