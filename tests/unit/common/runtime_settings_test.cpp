#include "common/runtime/runtime_settings.hpp"

#include <sched.h>
#include <string>
#include <thread>

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

TEST(CoreChoice, IsNoneUnlessNamed) {
    EXPECT_EQ(read_core(ConfigFile::parse("", "x.toml")), kAnyCore);
    EXPECT_EQ(read_core(ConfigFile::parse("[runtime]\ncore = 3", "x.toml")), 3);
    EXPECT_THROW(runtime_settings("core = -2"), Error);
    EXPECT_NO_THROW(runtime_settings("core = 3")) << "a key that every program knows";
}

TEST(CoreChoice, KeepsTheThreadThereAndNoOther) {
    std::string refusal;
    int core = kAnyCore, cores = 0;
    std::thread([&] {
        cpu_set_t allowed;
        sched_getaffinity(0, sizeof allowed, &allowed);
        for (int i = 0; i < CPU_SETSIZE; ++i)
            core = CPU_ISSET(static_cast<std::size_t>(i), &allowed) ? i : core;
        refusal = keep_to_core(core);
        sched_getaffinity(0, sizeof allowed, &allowed);
        cores = CPU_COUNT(&allowed);
    }).join();
    EXPECT_EQ(refusal, "");
    EXPECT_EQ(cores, 1);
}

TEST(CoreChoice, SaysThatACoreIsNotThere) {
    if (std::thread::hardware_concurrency() > 1023) GTEST_SKIP() << "it is there";
    EXPECT_NE(keep_to_core(1023).find("cannot keep to core 1023"), std::string::npos);
    EXPECT_EQ(keep_to_core(kAnyCore), "");
}

}  // namespace
}  // namespace thimble
