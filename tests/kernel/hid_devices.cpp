// A program for the kernel lane: makes HID devices by /dev/uhid, which the kernel's own HID core then offers as hidraw nodes, and
// looks at them with what the nodes use. Says what it saw; exit code 1 with the first thing that is wrong.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <functional>
#include <linux/uhid.h>
#include <poll.h>
#include <stdexcept>
#include <unistd.h>

#include "common/hid/hid_connection.hpp"
#include "common/runtime/hid/hid_thread.hpp"
#include "common/runtime/wall_clock.hpp"
#include "cutaneous_node/board/board_actuator.hpp"
#include "master/devices/hid/hid_hand.hpp"
#include "tests/devices/mock_devices.hpp"

namespace {

using namespace thimble;
using std::chrono::milliseconds;

constexpr Duration kPatienceHere = std::chrono::seconds{5};

void demand(bool holds, const std::string& what) {
    if (!holds) throw std::runtime_error(what);
    std::printf("good: %s\n", what.c_str());
}

// A device that is plugged in as long as this lives.
class UhidDevice {
  public:
    explicit UhidDevice(const MockHidDevice& device) : file_(open("/dev/uhid", O_RDWR | O_CLOEXEC)) {
        if (file_ < 0) throw std::runtime_error("no /dev/uhid: is the module uhid loaded?");
        uhid_event event{};
        event.type = UHID_CREATE2;
        auto& create = event.u.create2;
        std::copy(device.name.begin(), device.name.end(), create.name);
        std::copy(device.serial.begin(), device.serial.end(), create.uniq);
        std::copy(device.descriptor.begin(), device.descriptor.end(), create.rd_data);
        create.rd_size = static_cast<std::uint16_t>(device.descriptor.size());
        create.bus = 0x03;  // USB
        create.vendor = device.vendor;
        create.product = device.product;
        send(event);
    }
    ~UhidDevice() { close(file_); }
    UhidDevice(const UhidDevice&) = delete;
    UhidDevice& operator=(const UhidDevice&) = delete;

    void say(std::span<const std::uint8_t> report) {
        uhid_event event{};
        event.type = UHID_INPUT2;
        event.u.input2.size = static_cast<std::uint16_t>(report.size());
        std::copy(report.begin(), report.end(), event.u.input2.data);
        send(event);
    }
    // The newest report that it was told; empty if none.
    std::vector<std::uint8_t> hear() {
        std::vector<std::uint8_t> report;
        for (pollfd ready{file_, POLLIN, 0}; poll(&ready, 1, 0) > 0;) {
            uhid_event event{};
            if (read(file_, &event, sizeof event) <= 0) break;
            if (event.type != UHID_OUTPUT) continue;
            report.assign(event.u.output.data, event.u.output.data + event.u.output.size);
        }
        return report;
    }

  private:
    void send(const uhid_event& event) const {
        if (write(file_, &event, sizeof event) != static_cast<ssize_t>(sizeof event))
            throw std::runtime_error("the kernel refuses an event of uhid");
    }
    int file_;
};

class SteppedConnection {
  public:
    explicit SteppedConnection(HidUser& user)
        : connection_(*bus_, user, [](const std::string& words) { std::puts(words.c_str()); }) {}
    // Steps until the condition holds; how long that took, or kPatienceHere.
    Duration until(const std::function<bool()>& holds) {
        const SessionTime start = wall_now();
        while (!holds() && wall_now() - start < kPatienceHere) {
            if (connection_.step(wall_now()) > Duration::zero()) wall_sleep(milliseconds{10});
        }
        return std::min(wall_now() - start, kPatienceHere);
    }

  private:
    std::unique_ptr<HidBus> bus_ = make_hidapi_bus();
    HidConnection connection_;
};

void try_hand() {
    HidHand hand{HidHandSettings{}};
    SteppedConnection stepped(hand);
    {
        UhidDevice cap(mock_cap());
        demand(stepped.until([&] { return hand.deflection() == 0.0; }) < kPatienceHere,
               "a SpaceMouse is found, at rest");
        const std::array<std::uint8_t, 7> pushed{1, 0, 0, 0x5e, 0x01, 0, 0};
        cap.say(pushed);
        const Duration late = stepped.until([&] { return hand.deflection() == 1.0; });
        demand(late < milliseconds{1}, "its report is in hand within 1 ms");
        const SessionTime silent_until = wall_now() + std::chrono::seconds{2};
        stepped.until([&] { return wall_now() >= silent_until; });
        demand(hand.deflection() == 1.0, "2 s of silence are no loss");
        cap.say(std::array<std::uint8_t, 7>{1, 0, 0, 0xff, 0x7f, 0, 0});
        demand(stepped.until([&] { return hand.bad_reports() == 1; }) < kPatienceHere,
               "a report of nonsense is counted");
        demand(hand.deflection() == 1.0, "and moves nothing");
    }
    demand(stepped.until([&] { return !hand.deflection(); }) < milliseconds{200},
           "pulled out, it lets go within 200 ms");
    const UhidDevice again(mock_cap());
    demand(stepped.until([&] { return hand.deflection() == 0.0; }) < kPatienceHere,
           "put back, it is found again");
}

void try_board() {
    BoardActuator actuator(HidChoice{}, 1.5);
    SteppedConnection stepped(actuator);
    {
        UhidDevice board(mock_board());
        std::vector<std::uint8_t> told;
        const auto hears_force = [&](std::uint16_t force_mN) {
            actuator.command(wall_now(), Finger::kIndex, 1e-3 * force_mN);
            return stepped.until([&] {
                if (auto report = board.hear(); !report.empty()) told = report;
                const auto command = decode_board_command(told);
                return command && command->index_mN == force_mN;
            });
        };
        demand(hears_force(500) < kPatienceHere, "a board is found and told");
        demand(hears_force(1200) < milliseconds{5}, "a new force is with it within 5 ms");
        board.say(encode(BoardStatus{told[2], true, false, BoardFault::kNone, 1180, 0}));
        demand(stepped.until([&] { return actuator.output(wall_now()).force_N > 1; }) < milliseconds{5},
               "its answer is felt within 5 ms");
        demand(actuator.fault().empty(), "no trouble");
        const Duration silent = stepped.until([&] { return !actuator.fault().empty(); });
        demand(silent > milliseconds{90} && silent < milliseconds{110}, "100 ms of silence are trouble");
    }
    stepped.until([&] { return actuator.fault().find("not plugged in") != std::string_view::npos; });
    demand(actuator.output(wall_now()).force_N == 0, "pulled out, nothing is felt");
}

}  // namespace

int main() {
    try {
        try_hand();
        try_board();
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "wrong: %s\n", error.what());
        return 1;
    }
}
