// The Falcon's driver through the real libusb, with an emulated device below it (umockdev): found, loaded, read, pushed, lost.
#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <numeric>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/process/child.hpp"
#include "common/runtime/wall_clock.hpp"
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

    // Renews a force of 500 counts until `condition` is true.
    static bool comes_while_pushed(FalconGuardian& guardian, const std::function<bool()>& condition) {
        return comes([&] {
            guardian.mailbox().take_withheld();
            guardian.mailbox().command({500, 0, 0});
            return condition();
        });
    }
    static int motor(MockFalcon& falcon) {
        return falcon.with([](FalconEmulator& device) { return device.commanded.motors[0]; });
    }
    static void set(MockFalcon& falcon, bool FalconEmulator::*fault, bool value) {
        falcon.with([&](FalconEmulator& device) { device.*fault = value; });
    }
    // Of thimble-master with these tables. Its handle comes before its ports.
    std::vector<std::string> master_with(const std::string& tables) const {
        write_text(folder / "master.toml", "[handle]\ndevice = \"falcon\"\n" + tables);
        return {folder / "master.toml"};
    }

    TemporaryDirectory folder;
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
    write_text(folder / "falcon.bin", image);
    MockFalcon falcon(*bed_, 2, "F1");
    falcon.with([](FalconEmulator& device) {
        device.image_bytes = 500;
        device.zero_before_greeting = true;
    });
    EXPECT_THAT(why_not(), HasSubstr("the Falcon has lost its firmware"));
    settings.firmware = folder / "falcon.bin";
    settings.firmware_sha256 = std::string(64, '0');
    EXPECT_THAT(why_not(), HasSubstr("firmware_sha256 is 000"));
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

// The device is in order, and has its last force.
TEST_F(FalconUsb, ReadsThatFailLeaveNoForce) {
    MockFalcon falcon(*bed_, 2, "F1");
    falcon.with(make_ready);
    FalconGuardian guardian(settings, {}, THIMBLE_MASTER_FILE);
    ASSERT_TRUE(comes_while_pushed(guardian, [&] { return motor(falcon) == 500; }));
    set(falcon, &FalconEmulator::failing_reads, true);
    EXPECT_TRUE(comes_while_pushed(guardian, [&] { return guardian.mailbox().lost(); }));
    EXPECT_EQ(guardian.mailbox().loss(), FalconLoss::kUnplugged);
    EXPECT_TRUE(comes([&] { return motor(falcon) == 0; }));
    set(falcon, &FalconEmulator::failing_reads, false);
}

// The other direction is FalconProgram's. A new guardian can claim the device.
TEST_F(FalconUsb, AGuardianThatIsKilledOrStoppedLeavesNoForce) {
    MockFalcon falcon(*bed_, 2, "F1");
    falcon.with(make_ready);
    for (const int number : {SIGKILL, SIGSTOP}) {
        FalconGuardian guardian(settings, {}, THIMBLE_MASTER_FILE);
        ASSERT_TRUE(comes_while_pushed(guardian, [&] { return motor(falcon) == 500; })) << number;
        const SessionTime lost = wall_now();
        kill(guardian.pid(), number);
        EXPECT_TRUE(comes_while_pushed(guardian, [&] { return guardian.mailbox().lost(); })) << number;
        EXPECT_EQ(guardian.mailbox().loss(), FalconLoss::kGuardianEnded);
        EXPECT_TRUE(comes([&] { return motor(falcon) == 0; })) << number;
        EXPECT_LT(wall_now() - lost, std::chrono::seconds{1}) << "0.4 s are promised (kernel lane)";
    }
}

TEST_F(FalconUsb, TheForceIsTakenFromADeviceThatIsBusyForAWhileOrRefusesItsSettings) {
    MockFalcon falcon(*bed_, 2, "F1");
    falcon.with(make_ready);
    for (const bool busy : {true, false}) {
        FalconGuardian guardian(settings, {}, THIMBLE_MASTER_FILE);
        ASSERT_TRUE(comes_while_pushed(guardian, [&] { return motor(falcon) == 500; })) << busy;
        falcon.be_claimed_by_somebody(busy);
        set(falcon, &FalconEmulator::stalled_control, !busy);
        kill(guardian.pid(), SIGKILL);
        ASSERT_TRUE(comes([&] { return guardian.mailbox().lost(); }));
        wall_sleep(std::chrono::milliseconds{100});
        if (busy) {
            EXPECT_EQ(motor(falcon), 500);
        }
        falcon.be_claimed_by_somebody(false);
        EXPECT_TRUE(comes([&] { return motor(falcon) == 0; })) << busy;
        set(falcon, &FalconEmulator::stalled_control, false);
    }
}

// Its boot loader says nothing, and the upload begins again and again.
TEST_F(FalconUsb, AMasterThatLoadsTheFirmwareHearsASignal) {
    MockFalcon falcon(*bed_, 2, "F1");
    set(falcon, &FalconEmulator::deaf_loader, true);
    write_text(folder / "falcon.bin", "abc");
    // sha256sum of these three bytes
    const auto words = master_with(
        "[handle.falcon]\nfirmware = \"" + (folder / "falcon.bin").string() +
        "\"\nfirmware_sha256 = \"ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad\"\n");
    Child master(THIMBLE_MASTER_FILE, words, folder / "words");
    const auto says = [&](const char* text) { return master.last_lines().find(text) != std::string::npos; };
    ASSERT_TRUE(comes([&] { return says("loading the Falcon's firmware"); })) << master.last_lines();
    master.signal(SIGTERM);
    EXPECT_EQ(master.wait(std::chrono::seconds{60}), 1);
    EXPECT_TRUE(says("interrupted while the Falcon was starting")) << master.last_lines();
}

// It is refused for the device that is absent, not for its tables.
TEST_F(FalconUsb, AMasterTakesTheWindowOfTheGuardAlone) {
    const ProgramResult result =
        run_program(THIMBLE_MASTER_FILE, master_with("[guard]\nenergy_window_s = 2\n"), "", "");
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.output, HasSubstr("there is no Novint Falcon on the USB"));
}

TEST(FalconGuardian, IsStartedByTheMasterAlone) {
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{kFalconGuardian}, {kFalconGuardian, "", "", "", "0"}}) {
        const ProgramResult result = run_program(THIMBLE_MASTER_FILE, words, "", "");
        EXPECT_EQ(result.exit_code, 2);
        EXPECT_THAT(result.output, HasSubstr("thimble-master starts this program itself"));
    }
}

TEST_F(FalconUsb, TellsAbsentFromBusyAndOneFromTwo) {
    EXPECT_EQ(look_for_usb(0x0403, 0xcb48).presence, UsbPresence::kAbsent);
    EXPECT_THAT(why_not(), HasSubstr("there is no Novint Falcon on the USB"));
    MockFalcon first(*bed_, 2, "F1");
    first.with(make_ready);
    EXPECT_EQ(look_for_usb(0x0403, 0xcb48).presence, UsbPresence::kFree);
    EXPECT_EQ(look_for_usb(0x0403, 0x6001).presence, UsbPresence::kAbsent);
    EXPECT_EQ(look_for_usb(0x0403, std::nullopt).count, 1);
    first.be_claimed_by_somebody();
    EXPECT_THAT(why_not(), HasSubstr("another program uses it: `sudo fuser -v " + first.file()));
    MockFalcon second(*bed_, 3, "F2");
    second.with(make_ready);
    EXPECT_THAT(why_not(), HasSubstr("2 Falcons are connected, with the serial numbers F1, F2"));
    settings.serial = "F2";
    EXPECT_NO_THROW(open_here());
    settings.serial = "F3";
    EXPECT_THAT(why_not(), HasSubstr("with serial 'F3' (there are F1, F2)"));
}

TEST(UsbAdvice, NamesTheNextStep) {
    const auto advice = [](UsbPresence presence) {
        return usb_advice({presence, 1, "/dev/bus/usb/001/004"}, "Falcon", "70.rules");
    };
    EXPECT_THAT(advice(UsbPresence::kAbsent), HasSubstr("there is no Falcon on the USB: plug it in"));
    EXPECT_THAT(advice(UsbPresence::kForbidden),
                testing::AllOf(HasSubstr("this user may not open /dev/bus/usb/001/004"),
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
