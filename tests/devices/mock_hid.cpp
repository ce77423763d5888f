#include "tests/devices/mock_hid.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fcntl.h>
#include <linux/hidraw.h>
#include <map>
#include <poll.h>
#include <pty.h>
#include <stdexcept>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <fmt/format.h>

#include "tests/devices/mock_bed.hpp"

namespace thimble {

struct PluggedMock {
    MockHidDevice device;
    std::string path;  // in sysfs, of the USB device
    int board_end = -1, computer_end = -1;
    UMockdevIoctlBase* handler = nullptr;
};

namespace {

// hidapi's questions when it opens a device.
gboolean answer_ioctl(UMockdevIoctlBase* /*base*/, UMockdevIoctlClient* client, gpointer data) {
    const auto& device = static_cast<const PluggedMock*>(data)->device;
    const gulong request = umockdev_ioctl_client_get_request(client);
    UMockdevIoctlData* const argument = umockdev_ioctl_client_get_arg(client);
    UMockdevIoctlData* const memory = umockdev_ioctl_data_resolve(argument, 0, _IOC_SIZE(request), nullptr);
    const auto fill = [memory](auto value) {
        umockdev_ioctl_data_update(memory, 0, reinterpret_cast<guint8*>(&value), sizeof value);
    };
    int result = 0, error = 0;
    if (memory == nullptr) {
        result = -1, error = EFAULT;
    } else if (request == HIDIOCGRDESCSIZE) {
        fill(static_cast<int>(device.descriptor.size()));
    } else if (request == HIDIOCGRDESC) {
        hidraw_report_descriptor descriptor{};
        descriptor.size = static_cast<__u32>(device.descriptor.size());
        std::copy(device.descriptor.begin(), device.descriptor.end(), descriptor.value);
        fill(descriptor);
    } else {
        result = -1, error = EINVAL;
    }
    umockdev_ioctl_client_complete(client, result, error);
    if (memory != nullptr) g_object_unref(memory);
    return TRUE;
}

}  // namespace

struct MockHid::Impl {
    MockBed bed;
    std::map<unsigned, std::unique_ptr<PluggedMock>> plugged;
};

MockHid::MockHid() : impl_(std::make_unique<Impl>()) {}

MockHid::~MockHid() {
    while (!impl_->plugged.empty()) unplug(impl_->plugged.begin()->first);
}

void MockHid::plug(const MockHidDevice& device) {
    auto plugged = std::make_unique<PluggedMock>();
    plugged->device = device;
    const unsigned n = device.number;
    plugged->path = fmt::format("/devices/pci0/usb1/1-{}", n + 1);
    const std::string id = fmt::format("0003:{:04X}:{:04X}.{:04}", device.vendor, device.product, n + 1);
    const std::string interface = fmt::format("{}/1-{}:1.0", plugged->path, n + 1);
    const std::string hid = interface + "/" + id;
    impl_->bed.add(fmt::format(
        "P: {}\nN: bus/usb/001/{:03}\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\nE: BUSNUM=001\nE: "
        "DEVNUM={:03}\n"
        "A: idVendor={:04x}\\n\nA: idProduct={:04x}\\n\nA: manufacturer=Test\\n\nA: product={}\\n\n"
        "A: serial={}\\n\nA: bcdDevice=0100\\n\n\n"
        "P: {}\nE: DEVTYPE=usb_interface\nE: SUBSYSTEM=usb\nA: bInterfaceNumber=00\\n\n\n"
        "P: {}\nE: SUBSYSTEM=hid\nE: HID_ID=0003:{:08X}:{:08X}\nE: HID_NAME={}\nE: HID_UNIQ={}\n\n"
        "P: {}/hidraw/hidraw{}\nN: hidraw{}\nE: SUBSYSTEM=hidraw\nE: DEVNAME=/dev/hidraw{}\nE: "
        "MAJOR=246\n"
        "E: MINOR={}\nA: dev=246:{}\\n\nL: device=../../../{}\n\n",
        plugged->path, n + 2, n + 2, device.vendor, device.product, device.name, device.serial, interface,
        hid, device.vendor, device.product, device.name, device.serial, hid, n, n, n, n, n, id));
    umockdev_testbed_set_attribute_binary(impl_->bed.testbed(), ("/sys" + hid).c_str(), "report_descriptor",
                                          const_cast<guint8*>(device.descriptor.data()),
                                          static_cast<int>(device.descriptor.size()));
    std::array<char, 64> name{};
    if (openpty(&plugged->board_end, &plugged->computer_end, name.data(), nullptr, nullptr) != 0)
        throw std::runtime_error("no pseudo terminal");
    // A copy in a program that a test starts would keep the device alive when it is pulled out.
    for (const int end : {plugged->board_end, plugged->computer_end}) fcntl(end, F_SETFD, FD_CLOEXEC);
    termios mode{};
    tcgetattr(plugged->computer_end, &mode);
    cfmakeraw(&mode);
    tcsetattr(plugged->computer_end, TCSANOW, &mode);
    const std::string node = impl_->bed.vacate(fmt::format("/dev/hidraw{}", n));
    if (symlink(name.data(), node.c_str()) != 0) throw std::runtime_error("no link at " + node);
    plugged->handler = umockdev_ioctl_base_new();
    g_signal_connect(plugged->handler, "handle-ioctl", G_CALLBACK(answer_ioctl), plugged.get());
    impl_->bed.answer(fmt::format("/dev/hidraw{}", n), plugged->handler);
    impl_->plugged[n] = std::move(plugged);
}

void MockHid::unplug(unsigned number) {
    const auto plugged = std::move(impl_->plugged.at(number));
    impl_->plugged.erase(number);
    impl_->bed.ignore(fmt::format("/dev/hidraw{}", number));
    umockdev_testbed_remove_device(impl_->bed.testbed(), ("/sys" + plugged->path).c_str());
    close(plugged->board_end);
    close(plugged->computer_end);
    g_object_unref(plugged->handler);
}

void MockHid::say(unsigned number, std::span<const std::uint8_t> report) {
    const int end = impl_->plugged.at(number)->board_end;
    if (::write(end, report.data(), report.size()) != static_cast<ssize_t>(report.size()))
        throw std::runtime_error("the report did not fit");
}

// A terminal hands over bytes, not reports: what has begun is waited for.
std::vector<std::uint8_t> MockHid::hear(unsigned number, std::size_t size, Duration longest) {
    pollfd ready{impl_->plugged.at(number)->board_end, POLLIN, 0};
    const auto longest_ms = std::chrono::duration_cast<std::chrono::milliseconds>(longest).count();
    if (poll(&ready, 1, static_cast<int>(longest_ms)) <= 0) return {};
    std::vector<std::uint8_t> report(size);
    std::size_t got = 0;
    while (got < size) {
        const ssize_t more = ::read(ready.fd, report.data() + got, size - got);
        if (more <= 0) return {};
        got += static_cast<std::size_t>(more);
    }
    return report;
}

}  // namespace thimble
