// The Falcon's USB side, as its driver needs it: an FTDI serial chip that passes bytes to the firmware. The real one is
// UsbFalconLink; tests have an emulated device.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "common/time.hpp"

namespace thimble {

class FalconLink : boost::noncopyable {
  public:
    virtual ~FalconLink() = default;

    // A vendor's request to the chip, without data; a purge also drops what was read already. False if it failed.
    virtual bool control(std::uint8_t request, std::uint16_t value) = 0;
    virtual bool write(std::span<const std::uint8_t> bytes) = 0;
    // The bytes that have come, without the chip's own status bytes; waits at most `limit` for the first. Fewer than asked, or none, is no
    // failure: lost() tells.
    virtual std::size_t read(std::span<std::uint8_t> room, Duration limit) = 0;
    // The device is gone, or the last transfer failed for good.
    virtual bool lost() const = 0;
    virtual std::string last_error() const = 0;
};

// From power-up to the first report: settings of the FTDI chip, and the firmware, which the Falcon forgets without power. All block: for
// use before a session only. The firmware is Novint's and comes from a file the user names; nothing of it is here.
//
// 1.5 Mbaud, and an answer within 1 ms instead of the chip's 16. False if the chip refuses.
bool set_falcon_running(FalconLink& link);

// Whether a firmware runs in it: some commands without force, and a report to any of them
// that is not its echo.
bool falcon_answers(FalconLink& link);

// Sends the image, which the device echoes byte by byte: the only check there is. Several times if need be. Throws Error (run failed):
// the step that failed, why, and what to do.
void load_falcon_firmware(FalconLink& link, std::span<const std::uint8_t> image);

// The file's bytes. Throws Error: usage, if it cannot be read or has another SHA-256 than was said; both are named.
std::vector<std::uint8_t> read_falcon_firmware(const std::string& path, const std::string& sha256);

struct ClaimedFalcon {
    std::unique_ptr<FalconLink> link;  // releases the device when it goes
    std::string serial;
};

// The Falcon with this serial number; empty: the only one. Throws Error (usage) with what is missing and what to do.
ClaimedFalcon claim_falcon(const std::string& serial);

// No Falcon is on the USB.
bool falcon_is_absent();

}  // namespace thimble
