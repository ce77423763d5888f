// The words that the handle in the master and the guardian's exchange share, in memory of both processes. Each word is always whole, so
// neither side waits for the other and nothing is torn. A force that is not renewed ends (FalconExchange).
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include <boost/core/noncopyable.hpp>

#include "master/devices/falcon/falcon_packet.hpp"

namespace thimble {

struct alignas(8) FalconWord {  // as clang wants it to read and write the whole at once
    FalconTriple values{};      // motors or encoders
    std::uint8_t flags = 0;     // a report's buttons and legs; a command's count of withheld forces
    std::uint8_t count = 0;
    bool operator==(const FalconWord&) const = default;
};
static_assert(std::atomic<FalconWord>::is_always_lock_free);

enum class FalconLoss : std::uint8_t { kNone, kUnplugged, kGuardianEnded };

class FalconMailbox : boost::noncopyable {
  public:
    // The handle's side; any thread, one at a time.
    void command(const FalconTriple& motors) {
        command_.store({motors, known_, ++commands_}, std::memory_order_release);
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
    // The newest command was not answered: the exchange sends no force now.
    bool silent() const { return silent_.load(std::memory_order_acquire); }
    // The exchange sends no force now, or has sent none at some time since the last call: a command was not answered, or not renewed.
    // Later commands carry the count that was read here.
    bool take_withheld() {
        const std::uint8_t count = withholdings_.load(std::memory_order_acquire);
        const bool news = count != known_;
        known_ = count;
        return news || withheld_.load(std::memory_order_acquire) || silent();
    }
    bool lost() const { return loss() != FalconLoss::kNone; }
    FalconLoss loss() const { return loss_.load(std::memory_order_acquire); }
    // Changes as long as the exchange goes on.
    std::uint32_t turns() const { return turns_.load(std::memory_order_acquire); }
    void ask_to_end() { end_.store(true, std::memory_order_release); }

    // The exchange's side.
    FalconWord commanded() const { return command_.load(std::memory_order_acquire); }
    bool asked_to_end() const { return end_.load(std::memory_order_acquire); }
    void publish(const FalconReport& report) {
        pressed_ |= report.buttons;  // first, so that no reader misses it
        const auto flags = static_cast<std::uint8_t>(report.buttons | (report.homed_legs << 4));
        report_.store({report.encoders, flags, ++reports_}, std::memory_order_release);
        any_.store(true, std::memory_order_release);
    }
    // The handle's side had called take_withheld() for every withheld force before this command.
    bool is_informed(const FalconWord& command) const {
        return command.flags == withholdings_.load(std::memory_order_relaxed);
    }
    void withhold(bool withheld) {
        if (withheld && !withheld_.load(std::memory_order_relaxed))
            withholdings_.fetch_add(1, std::memory_order_release);
        withheld_.store(withheld, std::memory_order_release);
    }
    void turned(bool answered) {
        silent_.store(!answered, std::memory_order_release);
        turns_.fetch_add(1, std::memory_order_release);
    }
    // The first reason stays.
    void lose(FalconLoss why) {
        FalconLoss none = FalconLoss::kNone;
        loss_.compare_exchange_strong(none, why);
    }

  private:
    std::atomic<FalconWord> command_{}, report_{};
    std::atomic<std::uint32_t> turns_{0};
    std::atomic<std::uint8_t> pressed_{0};  // since the last take_buttons()
    std::atomic<bool> any_{false}, silent_{false}, end_{false};
    std::atomic<bool> withheld_{false};
    std::atomic<std::uint8_t> withholdings_{0};
    std::atomic<FalconLoss> loss_{FalconLoss::kNone};
    std::uint8_t commands_ = 0, reports_ = 0, known_ = 0;  // of one side each
};

}  // namespace thimble
