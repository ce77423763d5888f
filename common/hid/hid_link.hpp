// HID devices (USB and Bluetooth input) as the nodes see them: what is plugged in, and reports to and from one of them. Real:
// hidapi (runtime/hid/hidapi_bus.hpp).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "common/config.hpp"
#include "common/time.hpp"

namespace thimble {

struct HidDevice {
    std::string path;  // "/dev/hidraw3"
    std::string name, serial;
    std::uint16_t vendor = 0, product = 0;    // USB's numbers
    std::uint16_t usage_page = 0, usage = 0;  // what it says it is
};
// "SpaceMouse Compact (256f:c635) at /dev/hidraw3"
std::string to_string(const HidDevice& device);

// Which device a session means, where several are plugged in. Keys device_id = "256f:c635" and serial of a table.
struct HidChoice {
    std::uint16_t vendor = 0, product = 0;  // both 0: any
    std::string serial;                     // empty: any

    bool matches(const HidDevice& device) const;
};
// Throws Error (usage).
HidChoice read_hid_choice(const ConfigTable& table);

// One device, open.
class HidLink : boost::noncopyable {
  public:
    virtual ~HidLink() = default;

    // Waits for a report, at most `longest`. Its bytes, beginning with its number if the device numbers them; 0: none came;
    // negative: the device is gone.
    virtual int read(std::span<std::uint8_t> report, Duration longest) = 0;
    // The first byte is the report's number, 0 if the device does not number them. May wait for the device. False: it is gone.
    virtual bool write(std::span<const std::uint8_t> report) = 0;
};

class HidBus : boost::noncopyable {
  public:
    virtual ~HidBus() = default;

    // All HID devices of this machine, an entry for each of their application collections. Takes milliseconds.
    virtual std::vector<HidDevice> list() = 0;
    // Null: `why` says what the system says.
    virtual std::unique_ptr<HidLink> open(const HidDevice& device, std::string& why) = 0;
    // Its report descriptor; empty if that cannot be read.
    virtual std::vector<std::uint8_t> descriptor(const HidDevice& device) = 0;
};

}  // namespace thimble
