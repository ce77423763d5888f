// Sends commands and receives reports, over and over, in a thread of its own. The answer to a command takes the USB's next frame,
// about 1 ms, and the thread that reads the handle must not wait for it. The two threads share two words of 64 bits. Each is
// always whole, so neither thread waits for the other, and nothing is torn.
//
// A force that is not renewed ends: after kUnattendedTurns exchanges without a command the motors get zero. The device may also
// leave a command without an answer for 2 ms, or answer with garbage. Then commands without force follow until a report comes.
// The light is red before homing, blue while some legs are homed, green once all are.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <thread>
#include <utility>

#include <boost/core/noncopyable.hpp>

#include "master/devices/falcon/falcon_link.hpp"
#include "master/devices/falcon/falcon_packet.hpp"

namespace thimble {

inline std::uint8_t light_of(const FalconReport& report) {
    if (report.homed()) return kFalconGreen;
    return report.homed_legs == 0 ? kFalconRed : kFalconBlue;
}

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
    void start(std::function<void()> prepare = {}) {
        thread_ = std::thread([this, prepare = std::move(prepare)] {
            if (prepare) prepare();
            while (!stop_.load(std::memory_order_acquire) && turn()) {
            }
        });
    }

    // Ends it, with a last command without force.
    void stop() {
        stop_ = true;
        if (thread_.joinable()) thread_.join();
        if (!lost()) link_->write(encode(FalconCommand{}));
    }

    // One command and what comes back. False once the link is lost.
    bool turn() {
        const FalconWord word = command_.load(std::memory_order_acquire);
        unattended_ = word == carried_ ? unattended_ + 1 : 0;
        carried_ = word;
        FalconCommand command{word.values, true, light_};
        if (silent() || unattended_ > kUnattendedTurns) command.motors = {};
        const auto report = link_->write(encode(command)) ? listen() : std::nullopt;
        if (report) publish(*report);
        silent_.store(!report, std::memory_order_release);
        if (link_->lost()) lost_.store(true, std::memory_order_release);
        return !lost();
    }

    // From the handle's side; any thread, one at a time.
    void command(const FalconTriple& motors) {
        command_.store({motors, 0, ++commands_}, std::memory_order_release);
    }

    struct Latest {
        FalconReport report;
        std::uint8_t count = 0;  // changes with each report
        bool any = false;
    };
    Latest latest() const {
        if (!any_.load(std::memory_order_acquire)) return {};
        const FalconWord word = report_.load(std::memory_order_acquire);
        return {{word.values, static_cast<std::uint8_t>(word.flags & 0xfU),
                 static_cast<std::uint8_t>(word.flags >> 4)},
                word.count,
                true};
    }

    // All buttons that are down, or have been since the last call: FalconButton, together.
    std::uint8_t take_buttons() { return pressed_.exchange(0) | latest().report.buttons; }
    // The newest command was not answered: what is sent now has no force.
    bool silent() const { return silent_.load(std::memory_order_acquire); }
    bool lost() const { return lost_.load(std::memory_order_acquire); }

  private:
    // A report may come in two packets, or behind one that is empty. Later work belongs to the next turn.
    static constexpr int kReads = 2;
    static constexpr Duration kRead = std::chrono::milliseconds{1};

    std::optional<FalconReport> listen() {
        std::optional<FalconReport> report;
        for (int i = 0; i < kReads && !report; ++i) {
            std::array<std::uint8_t, 64> bytes{};
            report = reader_.take(std::span(bytes).first(link_->read(bytes, kRead)));
        }
        return report;
    }

    void publish(const FalconReport& report) {
        pressed_ |= report.buttons;  // first, so that no reader misses it
        const auto flags = static_cast<std::uint8_t>(report.buttons | (report.homed_legs << 4));
        report_.store({report.encoders, flags, ++reports_}, std::memory_order_release);
        any_.store(true, std::memory_order_release);
        light_ = light_of(report);
    }

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
