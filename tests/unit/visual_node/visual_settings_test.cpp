#include "visual_node/visual_settings.hpp"

#include <string>

#include <gtest/gtest.h>

#include "common/error.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

VisualSettings read(const std::string& text) {
    const ConfigFile file = ConfigFile::parse("[visual]\n" + text, "visual.toml");
    const VisualSettings settings = read_visual_settings(file.table("visual"));
    file.finish();
    return settings;
}

TEST(VisualSettings, DefaultsAreTheScreenOfTheExperiments) {
    const VisualSettings settings = read("");
    EXPECT_EQ(settings.refresh_Hz, 60);
    EXPECT_EQ(settings.pipeline, milliseconds{25});
    EXPECT_EQ(settings.bar_full_scale_N, 12);
    EXPECT_EQ(settings.bar_resolution, 400);
    EXPECT_EQ(settings.stale.after, milliseconds{100});
    EXPECT_TRUE(settings.vibration);
    EXPECT_EQ(settings.vibration_device, "");
}

TEST(VisualSettings, ReadsEveryKey) {
    const VisualSettings settings = read(
        "refresh_Hz = 144\npipeline_s = 0.005\nbar_full_scale_N = 20\nbar_resolution = 1000\n"
        "stale_after_s = 0.05\nvibration = false\nvibration_device = '/dev/input/event7'");
    EXPECT_EQ(settings.refresh_Hz, 144);
    EXPECT_EQ(settings.pipeline, milliseconds{5});
    EXPECT_EQ(settings.bar_full_scale_N, 20);
    EXPECT_EQ(settings.bar_resolution, 1000);
    EXPECT_EQ(settings.stale.after, milliseconds{50});
    EXPECT_FALSE(settings.vibration);
    EXPECT_EQ(settings.vibration_device, "/dev/input/event7");
}

TEST(VisualSettings, RefusesWhatIsOutOfRange) {
    for (const char* text : {"refresh_Hz = 0", "pipeline_s = -0.001", "bar_full_scale_N = 0",
                             "bar_resolution = 0", "stale_after_s = 0", "bar_px = 400"}) {
        EXPECT_THROW(read(text), Error) << text;
    }
}

}  // namespace
}  // namespace thimble
