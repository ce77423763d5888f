#include "common/error.hpp"
#include "common/runtime/hid/hid_thread.hpp"

#ifdef THIMBLE_DEVICES
#include <filesystem>
#include <fstream>
#include <hidapi.h>
#include <iterator>
#endif

namespace thimble {

#ifdef THIMBLE_DEVICES
namespace {

// hidapi's texts are wide; what is not ASCII says nothing to us.
std::string narrow(const wchar_t* text) {
    std::string narrowed;
    for (; text != nullptr && *text != L'\0'; ++text)
        narrowed += *text >= L' ' && *text <= L'~' ? static_cast<char>(*text) : '?';
    return narrowed;
}

class HidapiLink final : public HidLink {
  public:
    explicit HidapiLink(hid_device* device) : device_(device) {}
    ~HidapiLink() override { hid_close(device_); }
    int read(std::span<std::uint8_t> report, Duration longest) override {
        const auto longest_ms = std::chrono::duration_cast<std::chrono::milliseconds>(longest).count();
        return hid_read_timeout(device_, report.data(), report.size(), static_cast<int>(longest_ms));
    }
    bool write(std::span<const std::uint8_t> report) override {
        return hid_write(device_, report.data(), report.size()) >= 0;
    }

  private:
    hid_device* device_;
};

class HidapiBus final : public HidBus {
  public:
    HidapiBus() {
        if (hid_init() != 0)
            throw Error(ExitCode::kRunFailed, "hidapi does not work: is the udev library installed?");
    }
    ~HidapiBus() override { hid_exit(); }

    std::vector<HidDevice> list() override {
        std::vector<HidDevice> devices;
        hid_device_info* const first = hid_enumerate(0, 0);
        for (const hid_device_info* info = first; info != nullptr; info = info->next) {
            devices.push_back({info->path, narrow(info->product_string), narrow(info->serial_number),
                               info->vendor_id, info->product_id, info->usage_page, info->usage});
        }
        hid_free_enumeration(first);
        return devices;
    }

    std::unique_ptr<HidLink> open(const HidDevice& device, std::string& why) override {
        if (hid_device* const opened = hid_open_path(device.path.c_str()))
            return std::make_unique<HidapiLink>(opened);
        why = narrow(hid_error(nullptr));
        return nullptr;
    }

    std::vector<std::uint8_t> descriptor(const HidDevice& device) override {
        const std::filesystem::path node = device.path;
        std::ifstream file("/sys/class/hidraw" / node.filename() / "device/report_descriptor",
                           std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
};

}  // namespace

std::unique_ptr<HidBus> make_hidapi_bus() { return std::make_unique<HidapiBus>(); }

#else

std::unique_ptr<HidBus> make_hidapi_bus() {
    throw Error(ExitCode::kUsage,
                "this build has no support for HID devices: configure it with -DTHIMBLE_DEVICES=ON, or "
                "choose another device");
}

#endif

}  // namespace thimble
