// The Falcon's USB side, as its driver needs it: an FTDI serial chip that passes bytes to the firmware. The real one is
// UsbFalconLink; tests have an emulated device.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "common/time.hpp"

namespace thimble {

class FalconLink {
  public:
    virtual ~FalconLink() = default;
    FalconLink() = default;
    FalconLink(const FalconLink&) = delete;
    FalconLink& operator=(const FalconLink&) = delete;

    // A vendor's request to the chip, without data. False if it failed.
    virtual bool control(std::uint8_t request, std::uint16_t value) = 0;
    virtual bool write(std::span<const std::uint8_t> bytes) = 0;
    // The bytes that have come, without the chip's own status bytes; waits at most `limit` for the first. Fewer than asked, or none, is no
    // failure: lost() tells.
    virtual std::size_t read(std::span<std::uint8_t> room, Duration limit) = 0;
    // The device is gone, or the last transfer failed for good.
    virtual bool lost() const = 0;
    virtual std::string last_error() const = 0;
};

}  // namespace thimble
