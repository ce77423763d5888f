// A trial as the Monitor would tell it: the needle goes in, meets the fixture and oscillates there at 15 Hz, as with 50 ms of
// delay, while the port gives out energy. A pure function of time: what a picture of it must show is known.
#pragma once

#include <array>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>
#include <vector>

#include "common/flow.hpp"
#include "common/messages.hpp"
#include "common/runtime/sockets.hpp"

namespace thimble {

inline constexpr double kDemonstrationFixture_m = 0.123;
inline constexpr double kDemonstrationAmplitude_m = 0.004;
inline constexpr double kDemonstrationContact_s = 3;  // when it gets there

Monitor demonstration(double time_s);

// The session's end of both views' ports, over loopback UDP: tells a demonstration, obeys delay, network, pause, start and end, and
// remembers what was asked. In a thread of its own, so that it goes on while a test waits for xdotool.
class FakeSession {
  public:
    // The demonstration has been running for `ahead_s`.
    FakeSession(std::uint16_t base_port, std::uint64_t instance, double ahead_s);

    // How often an order of this kind came, and the last one.
    int count(OrderKind kind);
    std::optional<Order> last(OrderKind kind);
    void obey(bool obeys);
    // A device has ended the trial, with these words.
    void fail(std::string_view words);

  private:
    // Hears, and speaks 250 times per second of `now`.
    void tick(SessionTime now);
    void take(const Order& order, SessionTime now);
    void speak(SessionTime now);

    Sockets sockets_;
    std::array<InboundFlow, 2> inbound_{InboundFlow{Role::kExperimenter}, InboundFlow{Role::kExperimenter}};
    std::array<Channel*, 2> views_;  // of the experimenter and of the player
    OutboundFlow monitors_;
    SessionTime started_, next_{};
    std::mutex mutex_;  // for what follows
    std::vector<Order> heard_;
    std::uint32_t trial_ = 4;
    double delay_s_ = 0.05;
    NetworkName network_;
    Modality modality_ = Modality::kHF;
    std::optional<DeviceFault> fault_;
    bool obeys_ = true, paused_ = false, running_ = true;
    std::jthread thread_;
};

}  // namespace thimble
