// Sends commands and receives reports, over and over, in the guardian's process (falcon_guardian.hpp). The answer to a command takes the
// USB's next frame, about 1 ms, and the thread that reads the handle must not wait for it.
//
// A force that is not renewed ends: after kUnattendedReads reads without a new command the motors get zero. So the force ends too when the
// master is killed or stopped. The device may also leave a command without an answer for 5 ms, or answer with garbage. Then commands
// without force follow until a report comes. The handle's side reads in the mailbox that a force was withheld, and only its later commands
// give a force again. So none comes back that the guard before the handle has not allowed anew.
//
// The light is red before homing, blue while some legs are homed, green once all are.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <boost/core/noncopyable.hpp>

#include "master/devices/falcon/falcon_link.hpp"
#include "master/devices/falcon/falcon_mailbox.hpp"
#include "master/devices/falcon/falcon_packet.hpp"

namespace thimble {

inline std::uint8_t light_of(const FalconReport& report) {
    if (report.homed()) return kFalconGreen;
    return report.homed_legs == 0 ? kFalconRed : kFalconBlue;
}

class FalconExchange : boost::noncopyable {
  public:
    // A read takes a frame of the USB, 1 ms and seldom 2. A clock would also count the time in which this machine stood still.
    static constexpr int kUnattendedReads = 20;
    static constexpr int kReads = 5;  // the patience with one answer

    // Both outlive it.
    FalconExchange(FalconLink& link, FalconMailbox& mailbox) : link_(&link), mailbox_(&mailbox) {}
    // With a last command without force: after a failed read a write may still work.
    ~FalconExchange() { link_->write(encode(FalconCommand{})); }

    // One command and what comes back. False once the link is lost.
    bool turn() {
        const FalconWord word = mailbox_->commanded();
        unattended_ = word == carried_ ? unattended_ + reads_ : 0;
        carried_ = word;
        const bool withheld =
            mailbox_->silent() || unattended_ > kUnattendedReads || !mailbox_->is_informed(word);
        mailbox_->withhold(withheld);
        FalconCommand command{word.values, true, light_};
        if (withheld) command.motors = {};
        const auto report = link_->write(encode(command)) ? listen() : std::nullopt;
        if (report) {
            mailbox_->publish(*report);
            light_ = light_of(*report);
        }
        mailbox_->turned(report.has_value());
        if (link_->lost()) mailbox_->lose(FalconLoss::kUnplugged);
        return !mailbox_->lost();
    }

  private:
    // Waits for two packets at most: a report may come in two, or after an empty one.
    static constexpr Duration kRead = std::chrono::milliseconds{1};

    std::optional<FalconReport> listen() {
        std::optional<FalconReport> report;
        for (reads_ = 0; reads_ < kReads && !report; ++reads_) {
            std::array<std::uint8_t, 64> bytes{};
            report = reader_.take(std::span(bytes).first(link_->read(bytes, kRead)));
        }
        return report;
    }

    FalconLink* link_;
    FalconMailbox* mailbox_;
    FalconReportReader reader_;
    FalconWord carried_;              // command that the last turn sent
    int unattended_ = 0, reads_ = 1;  // since it came; of the last turn
    std::uint8_t light_ = kFalconRed;
};

}  // namespace thimble
