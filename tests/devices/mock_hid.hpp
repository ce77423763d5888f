// HID devices on a bed of their own (mock_bed.hpp): hidapi itself talks to them. Reports go over a raw pseudo terminal, so that
// waiting for them is real.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/time.hpp"

namespace thimble {

struct MockHidDevice {
    unsigned number = 0;  // of /dev/hidrawN
    std::uint16_t vendor = 0, product = 0;
    std::string name, serial;
    std::vector<std::uint8_t> descriptor;
};

class MockHid {
  public:
    MockHid();
    ~MockHid();
    MockHid(const MockHid&) = delete;
    MockHid& operator=(const MockHid&) = delete;

    void plug(const MockHidDevice& device);
    void unplug(unsigned number);
    // The device says this.
    void say(unsigned number, std::span<const std::uint8_t> report);
    // The reports that it got; empty if none came within `longest`.
    std::vector<std::uint8_t> hear(unsigned number, std::size_t size, Duration longest);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace thimble
