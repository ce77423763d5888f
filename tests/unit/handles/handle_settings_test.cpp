// Which handle, which axis, which firmware: what a session file may say.
#include "master/devices/handle_settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"

namespace thimble {
namespace {

HandleSettings handle_from(const std::string& text) {
    const ConfigFile file = ConfigFile::parse(text, "test");
    HandleSettings settings = read_handle_settings(file.table("handle"));
    file.finish();
    return settings;
}

TEST(RealHandleSettings, ReadAsTheyAreWritten) {
    const HandleSettings settings = handle_from(R"(
[handle]
device = "force-dimension"
force_limit_N = 8
[handle.force_dimension]
axis = "+y"
origin_m = 0.01
lateral = "virtual"
lateral_stiffness_N_per_m = 2000
library = "/opt/sdk/libdhd.so.3"
serial = 1234
watchdog = false
)");
    EXPECT_EQ(settings.kind, HandleKind::kForceDimension);
    EXPECT_TRUE(held_by_person(settings.kind));
    EXPECT_EQ(settings.force_dimension.axis.axis, 1U);
    EXPECT_EQ(settings.force_dimension.axis.sign, 1);
    EXPECT_EQ(settings.force_dimension.axis.origin_m, 0.01);
    EXPECT_EQ(settings.force_dimension.axis.lateral, LateralHold::kVirtual);
    EXPECT_EQ(settings.force_dimension.axis.lateral_stiffness_N_per_m, 2000);
    EXPECT_EQ(settings.force_dimension.library, "/opt/sdk/libdhd.so.3");
    EXPECT_EQ(settings.force_dimension.serial, 1234);
    EXPECT_FALSE(settings.force_dimension.watchdog);
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

TEST(RealHandleSettings, WhichFalconButtonStops) {
    const auto buttons = [](const std::string& word) {
        return handle_from("[handle.falcon]\nstop_button = \"" + word + "\"\n").falcon.stop_buttons;
    };
    EXPECT_EQ(handle_from("").falcon.stop_buttons, kFalconAnyButton);
    EXPECT_EQ(buttons("any"), kFalconAnyButton);
    EXPECT_EQ(buttons("none"), 0);
    EXPECT_EQ(buttons("plus"), kFalconPlus);
    EXPECT_EQ(buttons("forward"), kFalconForward);
    EXPECT_EQ(buttons("centre"), kFalconCentre);
    EXPECT_EQ(buttons("minus"), kFalconMinus);
    try {
        buttons("middle");
        FAIL() << "no such button";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("handle.falcon.stop_button"));
        EXPECT_THAT(error.what(), testing::HasSubstr("centre"));
    }
}

TEST(RealHandleSettings, FirmwareNeedsItsSum) {
    EXPECT_ANY_THROW(handle_from("[handle.falcon]\nfirmware = \"a.bin\"\n"));
    EXPECT_ANY_THROW(handle_from("[handle.falcon]\nfirmware = \"a.bin\"\nfirmware_sha256 = \"abc\"\n"));
    EXPECT_ANY_THROW(handle_from("[handle.falcon]\nlateral_stiffness_N_per_m = 4000\n"));
    EXPECT_ANY_THROW(handle_from("[handle.falcon]\nspeed = 1\n"));
    const std::string sum(64, 'a');
    EXPECT_EQ(handle_from("[handle.falcon]\nfirmware = \"a.bin\"\nfirmware_sha256 = \"" + sum + "\"\n")
                  .falcon.firmware_sha256,
              sum);
}

}  // namespace
}  // namespace thimble
