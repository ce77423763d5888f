#include "common/runtime/runtime_settings.hpp"

#include <string>

#include <gtest/gtest.h>

#include "common/error.hpp"

namespace thimble {
namespace {

RuntimeSettings runtime_settings(const std::string& text) {
    const ConfigFile file = ConfigFile::parse("[runtime]\n" + text, "runtime.toml");
    const RuntimeSettings settings = read_runtime_settings(file);
    file.finish();
    return settings;
}

TEST(RuntimeSettings, ReadsEveryKey) {
    const RuntimeSettings s =
        runtime_settings("realtime_scheduling = false\npriority = 98\nallowed_miss_fraction = 0.5");
    EXPECT_FALSE(s.realtime_scheduling);
    EXPECT_EQ(s.priority, 98);
    EXPECT_EQ(s.allowed_miss_fraction, 0.5);
    EXPECT_TRUE(runtime_settings("").realtime_scheduling);
    EXPECT_EQ(runtime_settings("").overrun, OverrunPolicy::kWarn);
    EXPECT_EQ(runtime_settings("overrun = 'rest'\noverrun_limit = 7").overrun, OverrunPolicy::kRest);
    EXPECT_EQ(runtime_settings("overrun = 'stop'\noverrun_limit = 7").overrun_limit, 7U);
}

TEST(RuntimeSettings, RefusesWhatIsOutOfRange) {
    for (const char* text :
         {"priority = 0", "priority = 99", "realtime_scheduling = 1", "allowed_miss_fraction = 1.5",
          "prio = 3", "overrun = 'end'", "overrun_limit = 0"}) {
        EXPECT_THROW(runtime_settings(text), Error) << text;
    }
}

}  // namespace
}  // namespace thimble
