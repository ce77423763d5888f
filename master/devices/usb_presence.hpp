// Is a USB device plugged in, may we open it, does another program use it? With advice as text.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace thimble {

enum class UsbPresence : std::uint8_t {
    kUnknown,  // built without libusb, or no USB at all on this machine
    kAbsent,
    kForbidden,  // it is there, and its file may not be written
    kBusy,       // another program has claimed it
    kFree,
};

struct UsbFinding {
    UsbPresence presence = UsbPresence::kUnknown;
    int count = 0;     // of such devices
    std::string file;  // "/dev/bus/usb/001/004" of the first
};

// Opens and claims each for a moment. Any product of the vendor, where none is named.
UsbFinding look_for_usb(std::uint16_t vendor, std::optional<std::uint16_t> product);

// The finding in words for the device with this name, and the udev rule or the command that helps; `rule` is a file of deploy/udev.
std::string usb_advice(const UsbFinding& finding, const std::string& device, const std::string& rule);

}  // namespace thimble
