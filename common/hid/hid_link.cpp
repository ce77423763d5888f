#include "common/hid/hid_link.hpp"

#include <charconv>

#include <fmt/format.h>

namespace thimble {
namespace {

bool read_hex(std::string_view text, std::uint16_t& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, 16);
    return error == std::errc{} && end == text.data() + text.size();
}

}  // namespace

std::string to_string(const HidDevice& device) {
    return fmt::format("{} ({:04x}:{:04x}) at {}", device.name.empty() ? "HID device" : device.name,
                       device.vendor, device.product, device.path);
}

bool HidChoice::matches(const HidDevice& device) const {
    const bool any = vendor == 0 && product == 0;
    return (any || (device.vendor == vendor && device.product == product)) &&
           (serial.empty() || device.serial == serial);
}

HidChoice read_hid_choice(const ConfigTable& table) {
    HidChoice choice;
    std::string id;
    table.read("serial", choice.serial, "Where two of one kind are plugged in; empty: any.");
    table.read("device_id", id, "USB's vendor and product, as lsusb shows them: 256f:c635; empty: any.");
    if (id.empty()) return choice;
    if (id.size() != 9 || id[4] != ':' || !read_hex(std::string_view(id).substr(0, 4), choice.vendor) ||
        !read_hex(std::string_view(id).substr(5), choice.product)) {
        table.fail("device_id", "is \"{}\"; use the numbers that lsusb shows, as \"256f:c635\"", id);
    }
    return choice;
}

}  // namespace thimble
