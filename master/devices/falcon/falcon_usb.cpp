#include <algorithm>
#include <array>
#include <libusb-1.0/libusb.h>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <boost/core/noncopyable.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"
#include "master/devices/falcon/falcon_link.hpp"
#include "master/devices/usb_presence.hpp"

namespace thimble {
namespace {

constexpr std::uint16_t kVendor = 0x0403, kProduct = 0xcb48;
constexpr unsigned char kOut = 0x02, kIn = 0x81;
constexpr int kUsbPacket = 64, kChipStatus = 2;
constexpr unsigned kWriteLimit_ms = 100;
constexpr std::uint8_t kVendorRequest = 0x40;  // to the device, no data
constexpr std::uint8_t kResetChip = 0;         // which also purges what came

// Every packet that comes begins with two bytes of the chip's own.
class UsbFalconLink : public FalconLink {
  public:
    explicit UsbFalconLink(libusb_device_handle* handle) : handle_(handle) {}

    bool control(std::uint8_t request, std::uint16_t value) override {
        if (request == kResetChip) kept_from_ = kept_count_;
        return note(libusb_control_transfer(handle_, kVendorRequest, request, value, 0, nullptr, 0,
                                            kWriteLimit_ms)) >= 0;
    }
    bool write(std::span<const std::uint8_t> bytes) override {
        int written = 0;
        auto* data = const_cast<std::uint8_t*>(bytes.data());  // libusb's prototype serves both directions
        const int answer = note(libusb_bulk_transfer(handle_, kOut, data, static_cast<int>(bytes.size()),
                                                     &written, kWriteLimit_ms));
        return answer == LIBUSB_SUCCESS && written == static_cast<int>(bytes.size());
    }
    // The chip answers even when it has nothing: packets of its status alone. Each of them counts as a millisecond of patience.
    std::size_t read(std::span<std::uint8_t> room, Duration limit) override {
        const auto limit_ms = std::max<std::int64_t>(1, limit.count() / 1'000'000);
        for (std::int64_t waited_ms = 0; waited_ms < limit_ms; ++waited_ms) {
            if (const std::size_t left = give(room); left > 0) return left;
            std::array<std::uint8_t, kUsbPacket> packet{};
            int got = 0;
            const int answer = note(libusb_bulk_transfer(handle_, kIn, packet.data(), kUsbPacket, &got,
                                                         static_cast<unsigned>(limit_ms)));
            if (answer != LIBUSB_SUCCESS && got <= kChipStatus) return 0;
            if (got > kChipStatus) {
                std::copy(packet.begin() + kChipStatus, packet.begin() + got, kept_.begin());
                kept_count_ = static_cast<std::size_t>(got - kChipStatus);
                kept_from_ = 0;
            }
        }
        return give(room);
    }
    bool lost() const override { return lost_; }
    std::string last_error() const override { return libusb_strerror(static_cast<libusb_error>(error_)); }

  private:
    int note(int answer) {
        if (answer < 0) error_ = answer;
        if (answer == LIBUSB_ERROR_NO_DEVICE || answer == LIBUSB_ERROR_IO || answer == LIBUSB_ERROR_PIPE)
            lost_ = true;
        return answer;
    }
    std::size_t give(std::span<std::uint8_t> room) {
        const std::size_t count = std::min(room.size(), kept_count_ - kept_from_);
        std::copy_n(kept_.begin() + static_cast<std::ptrdiff_t>(kept_from_), count, room.begin());
        kept_from_ += count;
        return count;
    }

    libusb_device_handle* handle_;
    std::array<std::uint8_t, kUsbPacket> kept_{};  // came, not yet read
    std::size_t kept_from_ = 0, kept_count_ = 0;
    int error_ = LIBUSB_SUCCESS;
    bool lost_ = false;
};

std::string usb_text(libusb_device_handle* handle, std::uint8_t index) {
    std::array<unsigned char, 64> text{};
    const int length =
        libusb_get_string_descriptor_ascii(handle, index, text.data(), static_cast<int>(text.size()));
    return length <= 0 ? "" : std::string(text.begin(), text.begin() + length);
}

std::string falcon_advice() {
    return usb_advice(look_for_usb(kVendor, kProduct), "Novint Falcon", "70-thimble-handles.rules");
}

// The claimed device; all that belongs to libusb goes with this object.
class OpenedUsb : boost::noncopyable {
  public:
    explicit OpenedUsb(const std::string& wanted_serial) {
        if (libusb_init(&context_) != LIBUSB_SUCCESS)
            throw Error(ExitCode::kUsage, "USB does not work on this machine (libusb)");
        try {
            find(wanted_serial);
        } catch (...) {
            close();
            throw;
        }
    }
    ~OpenedUsb() { close(); }

    libusb_device_handle* handle() const { return handle_; }
    const std::string& serial() const { return serial_; }

  private:
    void find(const std::string& wanted_serial) {
        libusb_device** devices = nullptr;
        const auto count = libusb_get_device_list(context_, &devices);
        std::vector<std::string> serials;
        for (ssize_t i = 0; i < count; ++i) consider(devices[i], wanted_serial, serials);
        if (count >= 0) libusb_free_device_list(devices, 1);
        std::sort(serials.begin(), serials.end());
        if (serials.size() > 1 && wanted_serial.empty()) {
            throw Error(
                ExitCode::kUsage,
                "{} Falcons are connected, with the serial numbers {}: name one in [handle.falcon] serial",
                serials.size(), fmt::join(serials, ", "));
        }
        if (handle_ == nullptr) {
            throw Error(ExitCode::kUsage, "found no Novint Falcon{}{}: {}",
                        wanted_serial.empty() ? "" : fmt::format(" with serial '{}'", wanted_serial),
                        serials.empty() ? "" : fmt::format(" (there are {})", fmt::join(serials, ", ")),
                        falcon_advice());
        }
        libusb_set_auto_detach_kernel_driver(handle_, 1);
        if (libusb_claim_interface(handle_, 0) != LIBUSB_SUCCESS)
            throw Error(ExitCode::kUsage, falcon_advice());
    }
    void consider(libusb_device* device, const std::string& wanted_serial,
                  std::vector<std::string>& serials) {
        libusb_device_descriptor descriptor{};
        if (libusb_get_device_descriptor(device, &descriptor) != LIBUSB_SUCCESS) return;
        if (descriptor.idVendor != kVendor || descriptor.idProduct != kProduct) return;
        libusb_device_handle* opened = nullptr;
        if (libusb_open(device, &opened) != LIBUSB_SUCCESS) return;
        serials.push_back(usb_text(opened, descriptor.iSerialNumber));
        if (handle_ == nullptr && (wanted_serial.empty() || serials.back() == wanted_serial)) {
            handle_ = opened;
            serial_ = serials.back();
        } else {
            libusb_close(opened);
        }
    }
    void close() {
        if (handle_ != nullptr) libusb_close(handle_);  // releases what is claimed
        libusb_exit(context_);
    }

    libusb_context* context_ = nullptr;
    libusb_device_handle* handle_ = nullptr;
    std::string serial_;
};

// The device goes after the link.
class OwningLink final : private OpenedUsb, public UsbFalconLink {
  public:
    explicit OwningLink(const std::string& wanted_serial)
        : OpenedUsb(wanted_serial), UsbFalconLink(OpenedUsb::handle()) {}
    using OpenedUsb::serial;
};

}  // namespace

ClaimedFalcon claim_falcon(const std::string& serial) {
    auto link = std::make_unique<OwningLink>(serial);
    std::string found = link->serial();
    return {std::move(link), std::move(found)};
}

bool falcon_is_absent() { return look_for_usb(kVendor, kProduct).presence == UsbPresence::kAbsent; }

}  // namespace thimble
