// Sends commands and receives reports, over and over, in a thread of its own. The answer to a command takes the USB's next frame,
// about 1 ms, and the thread that reads the handle must not wait for it. The two threads share two words of 64 bits. Each is
// always whole, so neither thread waits for the other, and nothing is torn.
//
// A force that is not renewed ends: after kUnattendedTurns exchanges without a command the motors get zero. The device may also
// leave a command without an answer for 2 ms, or answer with garbage. Then commands without force follow until a report comes.
// The light is red before homing, blue while some legs are homed, green once all are.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <thread>

#include <boost/core/noncopyable.hpp>

#include "master/devices/falcon/falcon_link.hpp"
#include "master/devices/falcon/falcon_packet.hpp"

namespace thimble {

struct alignas(8) FalconWord {  // as clang wants it to read and write the whole at once
    FalconTriple values{};      // motors or encoders
    std::uint8_t flags = 0, count = 0;
    bool operator==(const FalconWord&) const = default;
};
static_assert(std::atomic<FalconWord>::is_always_lock_free);

class FalconExchange : boost::noncopyable {
  public:
    static constexpr int kUnattendedTurns = 20;

    explicit FalconExchange(FalconLink& link) : link_(&link) {}
    ~FalconExchange() { stop(); }

    // The thread, which calls `prepare` first (scheduling belongs to threads). Without it a test calls turn().
    void start(std::function<void()> prepare = {});
    // Ends it, with a last command without force.
    void stop();

    // One command and what comes back. False once the link is lost.
    bool turn();

    // From the handle's side; any thread, one at a time.
    void command(const FalconTriple& motors);
    struct Latest {
        FalconReport report;
        std::uint8_t count = 0;  // changes with each report
        bool any = false;
    };
    Latest latest() const;
    // All buttons that are down, or have been since the last call: FalconButton, together.
    std::uint8_t take_buttons();
    // The newest command was not answered: what is sent now has no force.
    bool silent() const { return silent_.load(std::memory_order_acquire); }
    bool lost() const { return lost_.load(std::memory_order_acquire); }

  private:
    std::optional<FalconReport> listen();
    void publish(const FalconReport& report);

    FalconLink* link_;
    FalconReportReader reader_;
    std::atomic<FalconWord> command_{}, report_{};
    std::atomic<std::uint8_t> pressed_{0};  // since somebody asked
    std::atomic<bool> any_{false}, silent_{false}, lost_{false}, stop_{false};
    std::uint8_t commands_ = 0, reports_ = 0;
    FalconWord carried_;  // command that the last turn sent
    int unattended_ = 0;
    std::uint8_t light_ = kFalconRed;
    std::thread thread_;
};

}  // namespace thimble
