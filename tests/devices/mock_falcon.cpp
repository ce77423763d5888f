#include "tests/devices/mock_falcon.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <fcntl.h>
#include <iterator>
#include <linux/usbdevice_fs.h>
#include <stdexcept>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

// Device, configuration, interface, bulk IN 0x81, bulk OUT 0x02: a full-speed FTDI chip with the Falcon's numbers.
constexpr std::array<std::uint8_t, 50> kDescriptors{
    18,   1,  0, 2, 0, 0, 0, 64,   0x03, 0x04, 0x48, 0xcb, 0, 6,    1, 2,  3, 1, 9, 2, 32,   0, 1,  1, 0,
    0x80, 45, 9, 4, 0, 0, 2, 0xff, 0xff, 0xff, 2,    7,    5, 0x81, 2, 64, 0, 0, 7, 5, 0x02, 2, 64, 0, 0};
constexpr std::size_t kSetupBytes = 8;
constexpr int kPipeBytes = 4096;
constexpr Duration kTransfer =
    std::chrono::microseconds{500};  // a command and its report: a frame of the USB

std::string hexadecimal_digits() {
    std::string text;
    for (const std::uint8_t byte : kDescriptors) text += fmt::format("{:02X}", byte);
    return text;
}

std::vector<std::uint8_t> string_descriptor(unsigned index, const std::string& text) {
    if (index == 0) return {4, 3, 9, 4};  // US English
    std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(2 + 2 * text.size()), 3};
    for (const char letter : text) {
        bytes.push_back(static_cast<std::uint8_t>(letter));
        bytes.push_back(0);
    }
    return bytes;
}

// Into the program's memory; umockdev's prototype wants bytes that may change, and changes none.
void put_bytes(UMockdevIoctlData* data, std::size_t offset, std::vector<std::uint8_t> bytes) {
    umockdev_ioctl_data_update(data, offset, bytes.data(), static_cast<gint>(bytes.size()));
}

template <class Number>
void put_number(UMockdevIoctlData* data, std::size_t offset, Number number) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&number);
    put_bytes(data, offset, {bytes, bytes + sizeof number});
}

template <class Urbs>
auto find_of(Urbs& urbs, const UMockdevIoctlClient* client) {
    return std::find_if(urbs.begin(), urbs.end(), [client](const auto& urb) { return urb.client == client; });
}

}  // namespace

MockFalcon::MockFalcon(MockBed& bed, int number, std::string serial)
    : bed_(&bed),
      system_path_(fmt::format("/sys/devices/pci0/usb1/1-{}", number)),
      path_(fmt::format("/dev/bus/usb/001/{:03}", number)),
      serial_(std::move(serial)) {
    const std::string hex = hexadecimal_digits();
    const std::string device = fmt::format(
        "P: /devices/pci0/usb1/1-{0}\nN: bus/usb/001/{0:03}={1}\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\nE: "
        "BUSNUM=001\n"
        "E: DEVNUM={0:03}\nE: DEVNAME=/dev/bus/usb/001/{0:03}\nE: MAJOR=189\nE: MINOR={0}\nA: "
        "busnum=1\\n\nA: devnum={0}\\n\n"
        "A: speed=12\\n\nA: bConfigurationValue=1\\n\nA: bNumConfigurations=1\\n\nA: idVendor=0403\\n\nA: "
        "idProduct=cb48\\n\n"
        "H: descriptors={1}\n\n",
        number, hex);
    bed.add(device);
    // libusb waits until it may write to the device: a pipe that is full until a transfer is done.
    const std::string node = bed.vacate(path_);
    if (mkfifo(node.c_str(), 0666) != 0) throw std::runtime_error("no pipe at " + node);
    fifo_ = open(node.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    fcntl(fifo_, F_SETPIPE_SZ, kPipeBytes);
    signal_done();
    base_ = umockdev_ioctl_base_new();
    g_signal_connect(base_, "handle-ioctl", G_CALLBACK(on_ioctl), this);
    g_signal_connect(base_, "client-vanished", G_CALLBACK(on_vanished), this);
    bed.answer(path_, base_);
}

MockFalcon::~MockFalcon() {
    g_signal_handlers_disconnect_by_data(base_, this);
    g_object_unref(base_);
    for (UMockdevIoctlClient* client : held_) g_object_unref(client);
    for (const Urb& urb : pending_in_) forget(urb);
    for (const Urb& urb : done_) forget(urb);
    close(fifo_);
}

std::string MockFalcon::file() const { return path_; }

void MockFalcon::unplug() {
    const std::lock_guard lock(mutex_);
    emulator_.unplugged = true;
    while (!pending_in_.empty()) {
        finish(pending_in_.front(), -ENODEV, {}, 0, 0);
        pending_in_.pop_front();
    }
    signal_done();
    umockdev_testbed_remove_device(bed_->testbed(), system_path_.c_str());
}

int MockFalcon::on_ioctl(UMockdevIoctlBase* /*base*/, UMockdevIoctlClient* client, void* self) {
    // A real device has a processor of its own, so this thread, which is umockdev's, is scheduled as those of the nodes. It takes
    // the time of the USB: one that answered at once would keep the processor.
    static thread_local const std::string refusal = ask_for_realtime({});
    if (umockdev_ioctl_client_get_request(client) == USBDEVFS_SUBMITURB) wall_sleep(kTransfer);
    auto& mock = *static_cast<MockFalcon*>(self);
    // umockdev 0.17 forgets a client that is served while another one dies.
    if (mock.held_.insert(client).second) g_object_ref(client);
    return mock.serve(client);
}

// A kernel ends the transfers of a program that has died.
void MockFalcon::on_vanished(UMockdevIoctlBase* /*base*/, UMockdevIoctlClient* client, void* self) {
    auto& mock = *static_cast<MockFalcon*>(self);
    const std::lock_guard lock(mock.mutex_);
    const auto drop = [client](auto& urbs) {
        for (auto urb = urbs.begin(); urb != urbs.end();) {
            if (urb->client == client) forget(*urb);
            urb = urb->client == client ? urbs.erase(urb) : std::next(urb);
        }
    };
    drop(mock.pending_in_);
    drop(mock.done_);
    mock.signal_done();
}

int MockFalcon::serve(UMockdevIoctlClient* client) {
    const std::lock_guard lock(mutex_);
    UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
    const auto answer = [&](int error) {
        signal_done();
        umockdev_ioctl_client_complete(client, error == 0 ? 0 : -1, error);
        return 1;
    };
    const auto request = umockdev_ioctl_client_get_request(client);
    if (emulator_.unplugged && request != USBDEVFS_REAPURBNDELAY) return answer(ENODEV);
    switch (request) {
        case USBDEVFS_GET_CAPABILITIES: {
            const std::uint32_t can = USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_BULK_CONTINUATION |
                                      USBDEVFS_CAP_NO_PACKET_SIZE_LIM | USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
            UMockdevIoctlData* data = umockdev_ioctl_data_resolve(argument, 0, sizeof can, nullptr);
            if (data == nullptr) return answer(EFAULT);
            put_number(data, 0, can);
            g_object_unref(data);
            return answer(0);
        }
        case USBDEVFS_GETDRIVER:
            return answer(ENODATA);
        case USBDEVFS_CLAIMINTERFACE:
        case USBDEVFS_DISCONNECT_CLAIM:
            return answer(busy_ ? EBUSY : 0);
        case USBDEVFS_RELEASEINTERFACE:
        case USBDEVFS_SETCONFIGURATION:
            return answer(0);
        case USBDEVFS_SUBMITURB:
            return answer(submit(client) ? 0 : EFAULT);
        case USBDEVFS_DISCARDURB:
            return answer(discard(argument) ? 0 : EINVAL);
        case USBDEVFS_REAPURBNDELAY:
            if (reap(client)) return answer(0);
            return answer(emulator_.unplugged ? ENODEV : EAGAIN);
        default:
            return answer(ENOTTY);
    }
}

// False: the program has died meanwhile, and its memory with it.
bool MockFalcon::submit(UMockdevIoctlClient* client) {
    UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
    Urb urb;
    urb.client = client;
    urb.address = *reinterpret_cast<const std::uint64_t*>(argument->data);
    urb.urb = umockdev_ioctl_data_resolve(argument, 0, sizeof(usbdevfs_urb), nullptr);
    if (urb.urb == nullptr) return false;
    const auto& asked = *reinterpret_cast<const usbdevfs_urb*>(urb.urb->data);
    const int length = asked.buffer_length;
    if (length > 0) {
        urb.buffer = umockdev_ioctl_data_resolve(urb.urb, offsetof(usbdevfs_urb, buffer),
                                                 static_cast<gsize>(length), nullptr);
        if (urb.buffer == nullptr) {
            forget(urb);
            return false;
        }
    }
    if (asked.type == USBDEVFS_URB_TYPE_CONTROL) {
        control(urb);
        return true;
    }
    if (asked.endpoint == 0x02) {
        emulator_.receive({urb.buffer->data, static_cast<std::size_t>(length)});
        finish(urb, 0, {}, 0, length);
    } else {
        pending_in_.push_back(urb);
    }
    feed(client);
    return true;
}

void MockFalcon::control(Urb urb) {
    const std::uint8_t* setup = urb.buffer->data;
    const auto value = static_cast<std::uint16_t>(setup[2] | (setup[3] << 8));
    if (setup[0] == 0x80 && setup[1] == 6 && setup[3] == 3) {
        const auto text = string_descriptor(setup[2], serial_);
        return finish(urb, 0, text, kSetupBytes, static_cast<int>(text.size()));
    }
    const bool good = setup[0] == 0x40 && emulator_.control(setup[1], value);
    finish(urb, good ? 0 : -EPIPE, {}, 0, 0);
}

void MockFalcon::finish(Urb urb, int status, const std::vector<std::uint8_t>& data, std::size_t offset,
                        int length) {
    if (!data.empty()) put_bytes(urb.buffer, offset, data);
    put_number(urb.urb, offsetof(usbdevfs_urb, status), status);
    put_number(urb.urb, offsetof(usbdevfs_urb, actual_length), length);
    done_.push_back(urb);
}

// Two bytes of the chip's own before the firmware's. One who has died, and asked before, gets nothing.
void MockFalcon::feed(const UMockdevIoctlClient* client) {
    const auto next = [&] { return find_of(pending_in_, client); };
    for (auto urb = next(); urb != pending_in_.end() && emulator_.failing_reads; urb = next()) {
        finish(*urb, -EPROTO, {}, 0, 0);
        pending_in_.erase(urb);
    }
    for (auto urb = next(); urb != pending_in_.end() && emulator_.has_something(); urb = next()) {
        std::vector<std::uint8_t> packet{0x01, 0x60};
        const auto bytes = emulator_.transmit(62);
        packet.insert(packet.end(), bytes.begin(), bytes.end());
        finish(*urb, 0, packet, 0, static_cast<int>(packet.size()));
        pending_in_.erase(urb);
    }
}

bool MockFalcon::discard(UMockdevIoctlData* argument) {
    const auto address = *reinterpret_cast<const std::uint64_t*>(argument->data);
    const auto found = std::find_if(pending_in_.begin(), pending_in_.end(),
                                    [address](const Urb& urb) { return urb.address == address; });
    if (found == pending_in_.end()) return false;
    finish(*found, -ENOENT, {}, 0, 0);
    pending_in_.erase(found);
    return true;
}

bool MockFalcon::reap(UMockdevIoctlClient* client) {
    const auto urb = find_of(done_, client);
    if (urb == done_.end()) return false;
    UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
    UMockdevIoctlData* place = umockdev_ioctl_data_resolve(argument, 0, sizeof(void*), nullptr);
    if (place == nullptr) return false;
    umockdev_ioctl_data_set_ptr(place, 0, urb->urb);
    g_object_unref(place);
    forget(*urb);
    done_.erase(urb);
    return true;
}

void MockFalcon::forget(Urb urb) {
    if (urb.buffer != nullptr) g_object_unref(urb.buffer);
    if (urb.urb != nullptr) g_object_unref(urb.urb);
}

void MockFalcon::signal_done() {
    std::array<char, kPipeBytes> bytes{};
    const bool want_full = done_.empty() && !emulator_.unplugged;
    if (want_full == full_) return;
    const auto moved =
        want_full ? ::write(fifo_, bytes.data(), bytes.size()) : ::read(fifo_, bytes.data(), bytes.size());
    full_ = want_full && moved > 0;
}

}  // namespace thimble
