// An experimenter's view, or a player's panel, as a session sees it: hears the Monitor (and ReplayState), sends orders.
#pragma once

#include "common/flow.hpp"
#include "common/runtime/sockets.hpp"

namespace thimble {

class PlayedView {
  public:
    enum class Ports { kExperimenter, kPlayer };
    explicit PlayedView(std::uint16_t base_port, Ports ports = Ports::kExperimenter,
                        const SecuritySettings& security = {});

    void listen(SessionTime now);
    // For the trial that the Monitor showed last, as a view does it.
    void order(SessionTime now, const Order& order) { orders_.send(now, trial_, order); }

    const Monitor& monitor() const { return monitor_; }
    const ReplayState& replay() const { return replay_; }  // of length 0 before the first
    std::uint32_t trial() const { return trial_; }
    std::uint64_t heard() const { return heard_.counters().accepted; }
    bool running() const { return monitor_.state == NodeState::kRunning; }

  private:
    Sockets sockets_;
    Channel* link_;
    InboundFlow heard_{Role::kSession};
    OutboundFlow orders_;
    Monitor monitor_;
    ReplayState replay_;
    std::uint32_t trial_ = 0;
};

}  // namespace thimble
