// HID devices (USB and Bluetooth input) as the nodes see them: what is plugged in, and reports to and from one of them. Real:
// hidapi (runtime/hid/hid_thread.hpp).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <boost/core/noncopyable.hpp>
#include <fmt/format.h>

#include "common/config.hpp"
#include "common/decimal_text.hpp"
#include "common/time.hpp"

namespace thimble {

struct HidDevice {
    std::string path;  // "/dev/hidraw3"
    std::string name, serial;
    std::uint16_t vendor = 0, product = 0;    // USB's numbers
    std::uint16_t usage_page = 0, usage = 0;  // what it says it is
};
// "SpaceMouse Compact (256f:c635) at /dev/hidraw3"
inline std::string to_string(const HidDevice& device) {
    return fmt::format("{} ({:04x}:{:04x}) at {}", device.name.empty() ? "HID device" : device.name,
                       device.vendor, device.product, device.path);
}

// Which device a session means, where several are plugged in. Keys device_id = "256f:c635" and serial of a table.
struct HidChoice {
    std::uint16_t vendor = 0, product = 0;  // both 0: any
    std::string serial;                     // empty: any

    bool matches(const HidDevice& device) const {
        const bool any = vendor == 0 && product == 0;
        return (any || (device.vendor == vendor && device.product == product)) &&
               (serial.empty() || device.serial == serial);
    }
};
// Throws Error (usage).
inline HidChoice read_hid_choice(const ConfigTable& table) {
    HidChoice choice;
    std::string id;
    table.read("serial", choice.serial,
               "Serial number, if two devices of one kind are plugged in; empty: any.");
    table.read("device_id", id, "USB vendor and product, as lsusb prints them: 256f:c635; empty: any.");
    if (id.empty()) return choice;
    const auto vendor = parse_whole<std::uint16_t>(id.substr(0, id.find(':')), 16);
    const auto product = parse_whole<std::uint16_t>(id.substr(id.find(':') + 1), 16);
    if (id.size() != 9 || id[4] != ':' || !vendor || !product)
        table.fail("device_id", "is \"{}\"; use the numbers that lsusb shows, as \"256f:c635\"", id);
    choice.vendor = *vendor;
    choice.product = *product;
    return choice;
}

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
    // Null on failure; `why` gets the system's reason.
    virtual std::unique_ptr<HidLink> open(const HidDevice& device, std::string& why) = 0;
    // Its report descriptor; empty if that cannot be read.
    virtual std::vector<std::uint8_t> descriptor(const HidDevice& device) = 0;
};

}  // namespace thimble
