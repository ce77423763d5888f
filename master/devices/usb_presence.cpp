#include "master/devices/usb_presence.hpp"

#include <fmt/format.h>

#ifdef THIMBLE_DEVICES
#include <libusb-1.0/libusb.h>
#endif

namespace thimble {
namespace {

#ifdef THIMBLE_DEVICES
UsbPresence try_to_claim(libusb_device* device) {
    libusb_device_handle* handle = nullptr;
    const int opened = libusb_open(device, &handle);
    if (opened == LIBUSB_ERROR_ACCESS) return UsbPresence::kForbidden;
    if (opened != LIBUSB_SUCCESS) return UsbPresence::kBusy;
    const int claimed = libusb_claim_interface(handle, 0);
    if (claimed == LIBUSB_SUCCESS) libusb_release_interface(handle, 0);
    libusb_close(handle);
    return claimed == LIBUSB_ERROR_BUSY ? UsbPresence::kBusy : UsbPresence::kFree;
}

void look_at(libusb_device* device, UsbFinding& finding) {
    ++finding.count;
    if (finding.presence != UsbPresence::kAbsent) return;
    finding.presence = try_to_claim(device);
    finding.file =
        fmt::format("/dev/bus/usb/{:03}/{:03}", static_cast<unsigned>(libusb_get_bus_number(device)),
                    static_cast<unsigned>(libusb_get_device_address(device)));
}
#endif

}  // namespace

#ifdef THIMBLE_DEVICES
UsbFinding look_for_usb(std::uint16_t vendor, std::optional<std::uint16_t> product) {
    UsbFinding finding;
    libusb_context* context = nullptr;
    if (libusb_init(&context) != LIBUSB_SUCCESS) return finding;
    finding.presence = UsbPresence::kAbsent;
    libusb_device** devices = nullptr;
    const auto found = libusb_get_device_list(context, &devices);
    for (ssize_t i = 0; i < found; ++i) {
        libusb_device_descriptor descriptor{};
        if (libusb_get_device_descriptor(devices[i], &descriptor) != LIBUSB_SUCCESS) continue;
        if (descriptor.idVendor == vendor && descriptor.idProduct == product.value_or(descriptor.idProduct))
            look_at(devices[i], finding);
    }
    if (found >= 0) libusb_free_device_list(devices, 1);
    libusb_exit(context);
    return finding;
}
#else
UsbFinding look_for_usb(std::uint16_t, std::optional<std::uint16_t>) { return {}; }
#endif

std::string usb_advice(const UsbFinding& finding, const std::string& device, const std::string& rule) {
    switch (finding.presence) {
        case UsbPresence::kAbsent:
            return fmt::format("there is no {} on the USB: plug it in and switch it on; `lsusb` must list it",
                               device);
        case UsbPresence::kForbidden:
            return fmt::format(
                "a {} is on the USB, but this user may not open {}: run `sudo cp deploy/udev/{} "
                "/etc/udev/rules.d/ && sudo udevadm control --reload`, then unplug it and plug it in again",
                device, finding.file, rule);
        case UsbPresence::kBusy:
            return fmt::format(
                "a {} is on the USB, but another program uses it: `sudo fuser -v {}` names that program; end "
                "it",
                device, finding.file);
        case UsbPresence::kFree:
            return fmt::format("a {} is on the USB and can be opened: switch it off and on again", device);
        case UsbPresence::kUnknown:
            break;
    }
    return fmt::format("is a {} plugged in and switched on, and may this user open it (deploy/udev/{})?",
                       device, rule);
}

}  // namespace thimble
