#include "cutaneous_node/cutaneous_settings.hpp"

#include <string>

#include <gtest/gtest.h>

#include "common/error.hpp"

namespace thimble {
namespace {

CutaneousSettings read(const std::string& text) {
    const ConfigFile file = ConfigFile::parse("[cutaneous]\n" + text, "cutaneous.toml");
    const CutaneousSettings settings = read_cutaneous_settings(file.table("cutaneous"));
    file.finish();
    return settings;
}

TEST(CutaneousSettings, DrivesNeedABus) {
    EXPECT_EQ(read("").device, FingertipDevice::kSimulated);
    EXPECT_THROW(read("device = \"drives\""), Error);
    const CutaneousSettings settings = read("device = \"drives\"\n[cutaneous.drives]\nbus = \"can1\"");
    EXPECT_EQ(settings.device, FingertipDevice::kDrives);
    EXPECT_EQ(settings.drives.bus, "can1");
    EXPECT_EQ(settings.drives.fingers.size(), 4U);
}

TEST(CutaneousSettings, TheDeviceIsAskedForNoMoreThanTheGuardLetsThrough) {
    EXPECT_THROW(read("guard_limit_N = 1"), Error);
    EXPECT_THROW(read("force_limit_N = 6"), Error);
    EXPECT_EQ(read("force_limit_N = 6\nguard_limit_N = 6").force_limit_N, 6);
}

}  // namespace
}  // namespace thimble
