// The Falcon's driver through the real libusb, with an emulated device below it (umockdev): found, loaded, read, pushed, lost.
#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <numeric>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "master/devices/falcon/falcon_guardian.hpp"
#include "master/devices/falcon/falcon_handle.hpp"
#include "master/devices/usb_presence.hpp"
#include "tests/devices/mock_falcon.hpp"
#include "tests/refusal.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

constexpr double kLimit_N = 8;

class FalconUsb : public OnABed<MockBed> {
  protected:
    // Running and homed, the hand in the middle.
    static void make_ready(FalconEmulator& device) {
        device.running = true;
        device.put_hand_at({0, 0, 0.115});
    }
    // The guardian is the master's program: this one is gtest's.
    std::unique_ptr<Handle> open_here() const {
        return open_falcon(settings, kLimit_N, {}, THIMBLE_MASTER_FILE);
    }
    std::string why_not() const {
        return refusal([&] { open_here(); }, ExitCode::kUsage);
    }
    // The exchange has a thread of its own: waits for what it must bring. False if patience ended first.
    static bool comes(const std::function<bool()>& condition) {
        for (int i = 0; i < 5000; ++i) {
            if (condition()) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds{1});
        }
        return false;
    }

    FalconSettings settings;
    SessionTime now = at(std::chrono::milliseconds{5});  // stands still: no report is late
};

TEST_F(FalconUsb, IsReadAndPushed) {
    MockFalcon falcon(*bed_, 2, "F1");
    falcon.with(make_ready);
    const auto handle = open_here();
    EXPECT_EQ(handle->name(), "Novint Falcon, serial F1");
    ASSERT_TRUE(comes([&] { return handle->fault().empty(); }));
    handle->enable_force(now, true);
    EXPECT_NEAR(handle->read(now).position_hand_m, 0.010, 5e-5);
    EXPECT_TRUE(comes([&] {
        handle->command_force(now, 1);
        handle->read(now);
        return falcon.with([](FalconEmulator& device) { return device.commanded.motors[0] < -200; });
    }));
}

TEST_F(FalconUsb, GetsItsFirmware) {
    std::string image(500, '\0');
    std::iota(image.begin(), image.end(), char{0});
    const TemporaryDirectory folder;
    write_text(folder / "falcon.bin", image);
    MockFalcon falcon(*bed_, 2, "F1");
    falcon.with([](FalconEmulator& device) { device.image_bytes = 500; });
    EXPECT_THAT(why_not(), HasSubstr("the Falcon has no firmware"));
    settings.firmware = folder / "falcon.bin";
    settings.firmware_sha256 = std::string(64, '0');
    EXPECT_THAT(why_not(), HasSubstr("firmware_sha256 says 000"));
    // sha256sum of the bytes 0, 1, ... 255, 0, ... 243
    settings.firmware_sha256 = "6a259da4dacdfb0f51369649cbf8864d8e2d675462c8625a70334bfc2c50d1af";
    EXPECT_NO_THROW(open_here());
    EXPECT_TRUE(
        falcon.with([](FalconEmulator& device) { return device.running && device.loaded.size() == 500; }));
}

TEST_F(FalconUsb, UnpluggedInATrialItSaysSo) {
    MockFalcon falcon(*bed_, 2, "F1");
    falcon.with(make_ready);
    const auto handle = open_here();
    ASSERT_TRUE(comes([&] { return handle->fault().empty(); }));
    handle->enable_force(now, true);
    ASSERT_TRUE(handle->read(now).valid);
    falcon.unplug();
    ASSERT_TRUE(comes([&] { return !handle->read(now).valid; }));
    EXPECT_THAT(std::string(handle->fault()),
                HasSubstr("Novint Falcon, serial F1: it was unplugged or switched off"));
}

// The other direction is FalconProgram's. A new guardian can claim the device.
TEST_F(FalconUsb, AGuardianThatIsKilledOrStoppedLeavesNoForce) {
    MockFalcon falcon(*bed_, 2, "F1");
    falcon.with(make_ready);
    const auto motor = [&] { return falcon.with([](FalconEmulator& d) { return d.commanded.motors[0]; }); };
    for (const int number : {SIGKILL, SIGSTOP}) {
        FalconGuardian guardian(settings, {}, THIMBLE_MASTER_FILE);
        const auto pushed = [&] { guardian.mailbox().command({500, 0, 0}); };
        ASSERT_TRUE(comes([&] { return pushed(), motor() == 500; })) << number;
        kill(guardian.pid(), number);
        EXPECT_TRUE(comes([&] { return pushed(), guardian.mailbox().lost(); })) << number;
        EXPECT_EQ(guardian.mailbox().loss(), FalconLoss::kGuardianEnded);
        EXPECT_TRUE(comes([&] { return motor() == 0; })) << number;
    }
}

TEST(FalconGuardian, IsStartedByTheMasterAlone) {
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{kFalconGuardian}, {kFalconGuardian, "", "", "", "0"}}) {
        const ProgramResult result = run_program(THIMBLE_MASTER_FILE, words, "", "");
        EXPECT_EQ(result.exit_code, 2);
        EXPECT_THAT(result.output, HasSubstr("thimble-master starts this process itself"));
    }
}

TEST_F(FalconUsb, TellsAbsentFromBusyAndOneFromTwo) {
    EXPECT_EQ(look_for_usb(0x0403, 0xcb48).presence, UsbPresence::kAbsent);
    EXPECT_THAT(why_not(), HasSubstr("no Novint Falcon is on the USB"));
    MockFalcon first(*bed_, 2, "F1");
    first.with(make_ready);
    EXPECT_EQ(look_for_usb(0x0403, 0xcb48).presence, UsbPresence::kFree);
    EXPECT_EQ(look_for_usb(0x0403, 0x6001).presence, UsbPresence::kAbsent);
    EXPECT_EQ(look_for_usb(0x0403, std::nullopt).count, 1);
    first.be_claimed_by_somebody();
    EXPECT_THAT(why_not(), HasSubstr("another program has it: `sudo fuser -v " + first.file()));
    MockFalcon second(*bed_, 3, "F2");
    second.with(make_ready);
    EXPECT_THAT(why_not(), HasSubstr("2 Falcons are connected, with the serial numbers F1, F2"));
    settings.serial = "F2";
    EXPECT_NO_THROW(open_here());
    settings.serial = "F3";
    EXPECT_THAT(why_not(), HasSubstr("with serial 'F3' to be had (there are F1, F2)"));
}

TEST(UsbAdvice, NamesTheNextStep) {
    const auto advice = [](UsbPresence presence) {
        return usb_advice({presence, 1, "/dev/bus/usb/001/004"}, "Falcon", "70.rules");
    };
    EXPECT_THAT(advice(UsbPresence::kAbsent), HasSubstr("no Falcon is on the USB: plug it in"));
    EXPECT_THAT(advice(UsbPresence::kForbidden),
                testing::AllOf(HasSubstr("/dev/bus/usb/001/004 may not be opened"),
                               HasSubstr("sudo cp deploy/udev/70.rules")));
    EXPECT_THAT(advice(UsbPresence::kBusy), HasSubstr("fuser -v /dev/bus/usb/001/004"));
    EXPECT_THAT(advice(UsbPresence::kFree), HasSubstr("switch it off and on again"));
    EXPECT_THAT(advice(UsbPresence::kUnknown), HasSubstr("is a Falcon plugged in"));
}

TEST_F(FalconUsb, TellsForbidden) {
    if (geteuid() == 0) GTEST_SKIP() << "root may open everything: another user than root";
    MockFalcon falcon(*bed_, 2, "F1");
    std::filesystem::permissions(falcon.file(), std::filesystem::perms::none);
    EXPECT_EQ(look_for_usb(0x0403, 0xcb48).presence, UsbPresence::kForbidden);
    EXPECT_THAT(why_not(), HasSubstr("deploy/udev/70-thimble-handles.rules"));
}

}  // namespace
}  // namespace thimble
