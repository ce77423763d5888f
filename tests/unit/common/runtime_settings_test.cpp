#include "common/runtime/runtime_settings.hpp"

#include <sched.h>
#include <string>
#include <thread>

#include <gtest/gtest.h>

namespace thimble {
namespace {

TEST(RuntimeSettings, WhatAnOverrunDoes) {
    const RuntimeSettings s =
        read_runtime_settings(ConfigFile::parse("[runtime]\noverrun = 'stop'\noverrun_limit = 7", "x.toml"));
    EXPECT_EQ(s.overrun, OverrunPolicy::kStop);
    EXPECT_EQ(s.overrun_limit, 7U);
}

TEST(CoreChoice, IsNoneUnlessNamed) {
    EXPECT_EQ(read_core(ConfigFile::parse("", "x.toml")), kAnyCore);
    EXPECT_EQ(read_core(ConfigFile::parse("[runtime]\ncore = 3", "x.toml")), 3);
    const ConfigFile file = ConfigFile::parse("[runtime]\ncore = 3\noverrun = 'rest'", "x.toml");
    EXPECT_EQ(read_runtime_settings(file).overrun, OverrunPolicy::kRest);
    EXPECT_NO_THROW(file.finish()) << "a key that every program knows";
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
