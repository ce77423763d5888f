#include "cutaneous_node/cutaneous_settings.hpp"

#include <string>

#include <gtest/gtest.h>

#include "common/error.hpp"

namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

CutaneousSettings read(const std::string& text) {
    const ConfigFile file = ConfigFile::parse("[cutaneous]\n" + text, "cutaneous.toml");
    const CutaneousSettings settings = read_cutaneous_settings(file.table("cutaneous"));
    file.finish();
    return settings;
}

TEST(CutaneousSettings, DefaultsAreTheDeviceOfTheExperiments) {
    const CutaneousSettings settings = read("");
    EXPECT_EQ(settings.dead_time, milliseconds{45});
    EXPECT_EQ(settings.time_constant, Duration::zero());
    EXPECT_EQ(settings.force_limit_N, 1.5);
    EXPECT_EQ(settings.stale.after, milliseconds{100});
    EXPECT_EQ(settings.percept_period, milliseconds{1});
}

TEST(CutaneousSettings, ReadsEveryKey) {
    const CutaneousSettings settings = read(
        "dead_time_s = 0.01\ntime_constant_s = 0.02\nforce_limit_N = 3\nstale_after_s = 0.05\n"
        "percept_period_s = 0.0005");
    EXPECT_EQ(settings.dead_time, milliseconds{10});
    EXPECT_EQ(settings.time_constant, milliseconds{20});
    EXPECT_EQ(settings.force_limit_N, 3);
    EXPECT_EQ(settings.stale.after, milliseconds{50});
    EXPECT_EQ(settings.percept_period, microseconds{500});
}

TEST(CutaneousSettings, DrivesNeedABus) {
    EXPECT_EQ(read("").device, FingertipDevice::kSimulated);
    EXPECT_THROW(read("device = \"drives\""), Error);
    EXPECT_THROW(read("device = \"glove\""), Error);
    const CutaneousSettings settings = read("device = \"drives\"\n[cutaneous.drives]\nbus = \"can1\"");
    EXPECT_EQ(settings.device, FingertipDevice::kDrives);
    EXPECT_EQ(settings.drives.bus, "can1");
    EXPECT_EQ(settings.drives.fingers.size(), 4U);
}

TEST(CutaneousSettings, RefusesWhatIsOutOfRange) {
    for (const char* text : {"dead_time_s = -0.01", "time_constant_s = 2", "force_limit_N = 0",
                             "stale_after_s = 0", "stale = 'slack'", "guard_limit_N = 1", "force_limit_N = 6",
                             "percept_period_s = 0", "limit_N = 1"}) {
        EXPECT_THROW(read(text), Error) << text;
    }
}

}  // namespace
}  // namespace thimble
