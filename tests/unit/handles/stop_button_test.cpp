// Short presses of a handle's stop button between trials, when the master has nothing to do but heartbeats. A press may begin anywhere
// between two of them.
#include <cstdlib>
#include <filesystem>
#include <functional>

#include <gtest/gtest.h>

#include "master/devices/force_dimension/force_dimension_handle.hpp"
#include "master/devices/hid/hid_hand.hpp"
#include "master/master_process.hpp"
#include "tests/refusal.hpp"
#include "tests/unit/hid/fake_hid.hpp"
#include "tests/unit/queue_ports.hpp"
#include "tests/unit/session_time.hpp"
#ifdef THIMBLE_DEVICES
#include "master/devices/falcon/falcon_exchange.hpp"
#include "master/devices/falcon/falcon_handle.hpp"
#include "tests/unit/handles/falcon_emulator.hpp"
#endif

namespace thimble {
namespace {

using std::chrono::milliseconds;

constexpr int kPresses = 20;

// One millisecond of the device, with the button down or up.
using Turn = std::function<void(bool down)>;

// Whether a master without a session, which ticks only when it wants to, has stopped after a press.
template <class Handle>
bool is_heard(Handle& handle, const Turn& turn, Duration begin, Duration press) {
    QueuePorts ports;
    MasterProcess master(1, MasterSettings{}, ports, handle, handle);
    for (Duration time{}; time < milliseconds{400}; time += milliseconds{1}) {
        turn(time >= begin && time < begin + press);
        if (at(time) >= master.next_wakeup()) master.tick(at(time));
    }
    return master.stop_bus().stopped();
}

template <class Handle>
int heard_of(Handle& handle, const Turn& turn, Duration press) {
    int heard = 0;
    for (int i = 0; i < kPresses; ++i)
        heard += is_heard(handle, turn, milliseconds{101 + 5 * i}, press) ? 1 : 0;
    return heard;
}

template <class Handle>
void expect_all_heard(Handle& handle, const Turn& turn) {
    EXPECT_EQ(heard_of(handle, turn, Duration::zero()), 0) << "nobody presses";
    for (const int press_ms : {20, 40, 60, 80})
        EXPECT_EQ(heard_of(handle, turn, milliseconds{press_ms}), kPresses) << press_ms << " ms";
}

// A SpaceMouse whose first button is the stop.
struct Cap {
    Cap() {
        std::string trouble;
        EXPECT_TRUE(hand.attach(test::compact_cap(), {}, trouble)) << trouble;
    }
    static HidHandSettings with_button() {
        HidHandSettings settings;
        settings.stop_button = 1;
        return settings;
    }
    HidHandSettings settings = with_button();
    test::FakeCable cable;
    test::FakeLink link{cable};
    HidHand hand{settings};
};

TEST(StopButton, NoShortPressOfAHidDeviceIsMissed) {
    Cap cap;
    HidHandle handle(HandleSettings{}, cap.settings, cap.hand);
    bool was_down = false;
    expect_all_heard(handle, [&](bool down) {
        if (down != was_down) cap.cable.said.push_back({3, static_cast<std::uint8_t>(down ? 1 : 0), 0});
        was_down = down;
        cap.hand.turn({}, cap.link);
    });
}

TEST(StopButton, APressBeforeTheHidDeviceIsPulledOutCounts) {
    Cap cap;
    cap.cable.said.push_back({3, 1, 0});
    cap.hand.turn({}, cap.link);
    cap.hand.detach();
    EXPECT_TRUE(cap.hand.take_stop());
    EXPECT_FALSE(cap.hand.take_stop());
}

TEST(StopButton, NoShortPressOfAForceDimensionHandleIsMissed) {
    const TemporaryDirectory folder;
    write_text(folder / "script", "button_file " + (folder / "down").string() + "\n");
    setenv("THIMBLE_FAKE_DHD", (folder / "script").c_str(), 1);
    ForceDimensionSettings settings;
    settings.stop_button = 0;
    ForceDimensionHandle handle(settings, 12.0, DhdLibrary(THIMBLE_FAKE_DHD_FILE));
    bool was_down = false;
    expect_all_heard(handle, [&](bool down) {
        if (down && !was_down) write_text(folder / "down", "");
        if (!down && was_down) std::filesystem::remove(folder / "down");
        was_down = down;
    });
}

#ifdef THIMBLE_DEVICES
TEST(StopButton, NoShortPressOfAFalconIsMissed) {
    FalconEmulator device;
    EmulatedFalconLink link(device);
    FalconMailbox mailbox;
    FalconExchange exchange(link, mailbox);
    device.running = true;
    link.control(3, 0x0002);
    device.put_hand_at({0, 0, 0.115});
    FalconHandle handle(FalconSettings{}, 8, "Falcon", mailbox);
    expect_all_heard(handle, [&](bool down) {
        device.report.buttons = down ? kFalconForward : 0;
        exchange.turn();
    });
}
#endif

}  // namespace
}  // namespace thimble
