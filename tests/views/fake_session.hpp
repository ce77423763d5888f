// The session's end of both views' ports, over loopback UDP: tells a demonstration, obeys delay, network, pause, start and end, and
// remembers what was asked.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "common/flow.hpp"
#include "common/runtime/sockets.hpp"

namespace thimble {

class FakeSession {
  public:
    // `started`: when the demonstration's trial began.
    FakeSession(std::uint16_t base_port, std::uint64_t instance, SessionTime started);

    // Hears, and speaks 250 times per second of `now`.
    void tick(SessionTime now);
    void obey(bool obeys) { obeys_ = obeys; }
    // A device has ended the trial, with these words.
    void fail(std::string_view words) { fault_ = DeviceFault(words); }
    const std::vector<Order>& heard() const { return heard_; }
    // How often an order of this kind came.
    int count(OrderKind kind) const;
    std::uint32_t trial() const { return trial_; }
    double time_s(SessionTime now) const { return to_seconds(now - started_); }

  private:
    void take(const Order& order, SessionTime now);
    void speak(SessionTime now);

    Sockets sockets_;
    std::array<InboundFlow, 2> inbound_{InboundFlow{Role::kExperimenter}, InboundFlow{Role::kExperimenter}};
    OutboundFlow monitors_;
    std::array<Channel*, 2> orders_in_;  // of the experimenter and of the player
    SessionTime started_, next_{};
    std::vector<Order> heard_;
    std::uint32_t trial_ = 4;
    double delay_s_ = 0.05;
    NetworkName network_;
    Modality modality_ = Modality::kHF;
    std::optional<DeviceFault> fault_;
    bool obeys_ = true, paused_ = false, running_ = true;
};

}  // namespace thimble
