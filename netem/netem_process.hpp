// The relay: one directed link per flow, all delay of the system in its LinkModels. It forwards bytes and
// never looks inside them.
#pragma once

#include <vector>

#include "common/node_process.hpp"
#include "netem/link_model.hpp"

namespace thimble {

// What goes in at `from` comes out at `to`, later.
struct RelayPlan {
    Channel* from = nullptr;
    Channel* to = nullptr;
    LinkSettings link;
    std::uint32_t direction = 0;  // tells the links of a session apart in random draws
    Timeline timeline{};          // of each trial
};

struct Relay {
    explicit Relay(const RelayPlan& plan)
        : from(plan.from), to(plan.to), model(plan.link, StreamKey{}, plan.direction, plan.timeline) {}

    Channel* from;
    Channel* to;
    LinkModel model;
    LinkCounters before;  // of the trials before this one: the model starts anew with each
};

class NetemProcess final : public NodeProcess {
  public:
    NetemProcess(std::uint64_t instance, Channel& control, const std::vector<RelayPlan>& plans);

    const std::vector<Relay>& relays() const { return relays_; }

  protected:
    void begin_trial(SessionTime now, const SessionControl& control) override;
    void end_trial(SessionTime /*now*/) override {}  // what is in flight still arrives, as in a real network
    void work(SessionTime now) override;
    SessionTime next_work() const override;

  private:
    static void send_due(SessionTime now, Relay& relay);

    std::vector<Relay> relays_;
};

}  // namespace thimble
