// A Falcon that is not there: the FTDI chip's settings, the boot loader with its echo, the firmware's packets, three legs that stand
// where a hand puts them. The test sets its faults. Pure; FalconLink, umockdev and vhci bring bytes to it and back.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "master/devices/axis_constraint.hpp"
#include "master/devices/falcon/falcon_link.hpp"
#include "master/devices/falcon/falcon_packet.hpp"

namespace thimble {

class FalconEmulator {
  public:
    // False: the chip stalls the request.
    bool control(std::uint8_t request, std::uint16_t value);
    void receive(std::span<const std::uint8_t> bytes);
    // The bytes that wait for the host, at most so many.
    std::vector<std::uint8_t> transmit(std::size_t at_most);
    bool has_something() const { return !waiting_.empty(); }

    void put_hand_at(const DeviceVector& position_m);

    bool running = false;  // a firmware runs
    FalconReport report{{}, 0, 7};
    std::vector<std::uint8_t> loaded;
    std::size_t image_bytes = 0;  // after so many the boot loader starts what it got
    FalconCommand commanded;
    std::uint64_t commands = 0, commands_with_force = 0;

    // Faults.
    bool unplugged = false;
    bool failing_reads = false;         // of the USB, while writes work
    bool stalled_control = false;       // the chip stalls each request
    bool silent = false;                // takes commands, reports nothing
    bool deaf_loader = false;           // no greeting
    bool zero_before_greeting = false;  // a packet of 7 bytes with the chip's status, as some hosts get it
    int greetings_cut_short = 0;        // so many answers lack their end
    int reads_before_report = 0;        // of EmulatedFalconLink, which bring nothing
    std::optional<std::size_t> wrong_echo_at;  // once
    bool short_reports = false;
    std::size_t packet_bytes = 64;  // of what EmulatedFalconLink gives at once
    bool garbled_reports = false;

  private:
    enum class Stage { kOff, kGreeting, kBegin, kImage };
    void take(std::uint8_t byte);
    void take_boot(std::uint8_t byte);
    void answer(std::span<const std::uint8_t> bytes) {
        waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
    }

    Stage stage_ = Stage::kOff;
    std::uint16_t baud_ = 0;
    std::deque<std::uint8_t> heard_, waiting_;
};

// It, without a USB between.
class EmulatedFalconLink final : public FalconLink {
  public:
    explicit EmulatedFalconLink(FalconEmulator& device) : device_(&device) {}
    bool control(std::uint8_t request, std::uint16_t value) override;
    bool write(std::span<const std::uint8_t> bytes) override;
    std::size_t read(std::span<std::uint8_t> room, Duration limit) override;
    bool lost() const override { return device_->unplugged || device_->failing_reads; }
    std::string last_error() const override { return device_->unplugged ? "no such device" : "none"; }

  private:
    FalconEmulator* device_;
    int empty_reads_ = 0;  // still to come
};

}  // namespace thimble
