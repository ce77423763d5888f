// Which handle, which axis, which firmware: what a session file may say.
#include "master/devices/handle_settings.hpp"

#include <map>
#include <string>

#include <gtest/gtest.h>

#include "common/ros2_settings.hpp"

namespace thimble {
namespace {

HandleSettings handle_from(const std::string& text) {
    const ConfigFile file = ConfigFile::parse(text, "test");
    HandleSettings settings = read_handle_settings(file.table("handle"));
    file.finish();
    return settings;
}

TEST(RealHandleSettings, AnAxisIsAPlaceAndASign) {
    const ForceDimensionSettings read =
        handle_from("[handle.force_dimension]\naxis = '+y'\nlateral = 'virtual'\nwatchdog = false\n")
            .force_dimension;
    EXPECT_EQ(read.axis.axis, 1U);
    EXPECT_EQ(read.axis.sign, 1);
    EXPECT_EQ(read.axis.lateral, LateralHold::kVirtual);
    EXPECT_FALSE(read.watchdog);
}

TEST(HandleSettings, ReadsDeviceMechanicsAndCoupling) {
    const HandleSettings read = handle_from(
        "[handle]\ndevice = 'pointer'\ncoupling_stiffness_N_per_m = 800\ncoupling_damping_Ns_per_m = 20\n"
        "friction_N = 1.5\nforce_limit_N = 8.0\n");
    EXPECT_EQ(read.kind, HandleKind::kPointer);
    EXPECT_EQ(read.coupling.stiffness_N_per_m, 800);
    EXPECT_EQ(read.coupling.damping_Ns_per_m, 20);
    EXPECT_EQ(read.mechanics.friction_N, 1.5);
    EXPECT_EQ(read.force_limit_N, 8);
    EXPECT_EQ(handle_from("").kind, HandleKind::kSimulated);
    EXPECT_EQ(handle_from("").encoder_resolution_m, 1e-5);
    EXPECT_ANY_THROW(handle_from("[handle]\ndevice = 'mouse'\n"));
    const char* const weak = "[handle]\nforce_limit_N = 6\n";  // as strong as a hand behind a pointer
    EXPECT_ANY_THROW(handle_from(std::string(weak) + "device = 'hid'\n"));
    EXPECT_NO_THROW(handle_from(weak));
    EXPECT_ANY_THROW(
        read_handle_settings(ConfigFile::parse(weak, "test").table("handle"), HandleKind::kPointer));
}

TEST(RealHandleSettings, ADeviceOfAnotherProgramIsAsRealAsOnUsb) {
    const HandleSettings ros2 = handle_from("[handle]\ndevice = 'ros2'\n");
    EXPECT_TRUE(is_real(ros2.kind));
    EXPECT_TRUE(held_by_person(ros2.kind));
    EXPECT_EQ(user_limit(ros2), kRos2DriverLimit);
    EXPECT_FALSE(is_real(HandleKind::kHid));
    EXPECT_ANY_THROW(handle_from("[handle.ros2]\nport = 1\n"));
}

TEST(RealHandleSettings, DefaultsPushAwayFromTheUser) {
    const HandleSettings settings = handle_from("");
    EXPECT_FALSE(held_by_person(settings.kind));
    EXPECT_EQ(settings.force_dimension.axis.axis, 0U);
    EXPECT_EQ(settings.force_dimension.axis.sign, -1);
    EXPECT_EQ(settings.falcon.axis.axis, 2U);
    EXPECT_EQ(settings.falcon.axis.sign, -1);
    EXPECT_EQ(settings.falcon.axis.origin_m, 0.125);
}

TEST(RealHandleSettings, OnlyAFalconsUserIsWaitedFor) {
    EXPECT_EQ(user_limit(handle_from("")), Duration::zero());
    EXPECT_EQ(user_limit(handle_from("[handle]\ndevice = \"falcon\"\n")), std::chrono::seconds{60});
    EXPECT_EQ(user_limit(handle_from("[handle]\ndevice = \"falcon\"\nfalcon.homing_limit_s = 5\n")),
              std::chrono::seconds{5});
}

TEST(RealHandleSettings, ALimitSuitsTheDeviceWhereTheFileHasNone) {
    EXPECT_EQ(handle_from("").force_limit_N, 12);
    EXPECT_EQ(handle_from("[handle]\ndevice = 'touch'\n").force_limit_N, kTouchForce_N);
    const HandleSettings haply =
        handle_from("[handle]\ndevice = 'haply'\nforce_limit_N = 7\nhaply.force_key = 'vector'\n");
    EXPECT_EQ(haply.force_limit_N, 7);
    EXPECT_EQ(haply.haply.force_key, HaplyForceKey::kVector);
    EXPECT_EQ(haply.haply.port, 10001);
    EXPECT_TRUE(is_real(haply.kind));
    EXPECT_EQ(user_limit(haply), std::chrono::seconds{60});
    EXPECT_ANY_THROW(handle_from("[handle.haply]\nport = 0\n"));
    EXPECT_ANY_THROW(handle_from("[handle.touch]\nstop_button = 5\n"));
}

TEST(RealHandleSettings, WhichFalconButtonStops) {
    const auto buttons = [](const std::string& word) {
        return handle_from("[handle.falcon]\nstop_button = \"" + word + "\"\n").falcon.stop_buttons;
    };
    EXPECT_EQ(handle_from("").falcon.stop_buttons, kFalconAnyButton);
    const std::map<std::string, int> all{{"any", kFalconAnyButton}, {"none", 0},
                                         {"plus", kFalconPlus},     {"forward", kFalconForward},
                                         {"centre", kFalconCentre}, {"minus", kFalconMinus}};
    for (const auto& [word, button] : all) EXPECT_EQ(buttons(word), button) << word;
}

TEST(RealHandleSettings, FirmwareNeedsItsSum) {
    EXPECT_ANY_THROW(handle_from("[handle.falcon]\nfirmware = \"a.bin\"\n"));
    EXPECT_ANY_THROW(handle_from("[handle.falcon]\nfirmware = \"a.bin\"\nfirmware_sha256 = \"abc\"\n"));
    const std::string held = "[handle.falcon]\nlateral = 'virtual'\nlateral_stiffness_N_per_m = ";
    EXPECT_ANY_THROW(handle_from(held + "4000\n"));
    EXPECT_NO_THROW(handle_from(held + "3000\n"));
    EXPECT_ANY_THROW(handle_from("[handle.falcon]\nlateral_stiffness_N_per_m = 3000\n")) << "clamps hold it";
    const std::string sum(64, 'a');
    EXPECT_EQ(handle_from("[handle.falcon]\nfirmware = \"a.bin\"\nfirmware_sha256 = \"" + sum + "\"\n")
                  .falcon.firmware_sha256,
              sum);
}

}  // namespace
}  // namespace thimble
