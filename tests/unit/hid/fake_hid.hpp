// HID devices made of words: plugged in, read and pulled out by a test.
#pragma once

#include <deque>
#include <map>

#include "common/hid/hid_link.hpp"

namespace thimble::test {

using Report = std::vector<std::uint8_t>;

// What one open device has to say, and what it was told.
struct FakeCable {
    std::deque<Report> said;
    std::vector<Report> told;
    bool plugged = true;
};

class FakeLink final : public HidLink {
  public:
    explicit FakeLink(FakeCable& cable) : cable_(cable) {}
    int read(std::span<std::uint8_t> report, Duration /*longest*/) override {
        if (!cable_.plugged) return -1;
        if (cable_.said.empty()) return 0;
        const Report next = cable_.said.front();
        cable_.said.pop_front();
        const std::size_t size = std::min(next.size(), report.size());
        std::copy_n(next.begin(), size, report.begin());
        return static_cast<int>(size);
    }
    bool write(std::span<const std::uint8_t> report) override {
        if (!cable_.plugged) return false;
        cable_.told.emplace_back(report.begin(), report.end());
        return true;
    }

  private:
    FakeCable& cable_;
};

class FakeBus final : public HidBus {
  public:
    std::vector<HidDevice> list() override {
        ++listed;
        return present;
    }
    std::unique_ptr<HidLink> open(const HidDevice& device, std::string& why) override {
        if (forbidden) {
            why = "Permission denied";
            return nullptr;
        }
        return std::make_unique<FakeLink>(cables[device.path]);
    }
    std::vector<std::uint8_t> descriptor(const HidDevice& device) override {
        return descriptors[device.path];
    }

    std::vector<HidDevice> present;
    std::map<std::string, FakeCable> cables;
    std::map<std::string, Report> descriptors;
    bool forbidden = false;
    int listed = 0;
};

inline HidDevice compact_cap(const std::string& path = "/dev/hidraw0", const std::string& serial = "A1") {
    return {path, "SpaceMouse Compact", serial, 0x256f, 0xc635, 0x01, 0x08};
}

// Two sticks of 8 bits, 0 to 255, in report 1, and 8 buttons.
inline const Report kGamepadDescriptor{0x05, 0x01, 0x09, 0x05, 0xa1, 0x01, 0x85, 0x01, 0x09, 0x30, 0x09,
                                       0x31, 0x09, 0x32, 0x09, 0x35, 0x15, 0x00, 0x26, 0xff, 0x00, 0x75,
                                       0x08, 0x95, 0x04, 0x81, 0x02, 0x05, 0x09, 0x19, 0x01, 0x29, 0x08,
                                       0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x08, 0x81, 0x02, 0xc0};

}  // namespace thimble::test
