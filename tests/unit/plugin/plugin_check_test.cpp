// thimble board --check: each fault is found, and none in the example.
#include "study/board/plugin_check.hpp"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/plugin/plugins.hpp"

namespace thimble::test {
namespace {

using testing::HasSubstr;

// The rules that a fault breaks.
std::string broken(Fault fault, Duration limit = std::chrono::seconds{60}, const char* name = "bad") {
    std::string text;
    for (const PluginFinding& finding :
         check_plugin(plugin_file(name), {static_cast<double>(fault)}, limit).findings)
        if (!finding.kept) text += finding.rule + ": " + finding.words + "\n";
    return text;
}

TEST(PluginCheck, TheExampleKeepsAllRules) {
    const PluginCheck check = check_plugin(plugin_file("mine"));
    EXPECT_TRUE(check.good()) << check.text();
    EXPECT_EQ(check.exit_code(), 0);
    EXPECT_EQ(check.findings.size(), 6U) << "it does not say that it is passive";
    EXPECT_THAT(check.json(), HasSubstr("\"good\": true"));
}

TEST(PluginCheck, EachFaultIsNamed) {
    EXPECT_THAT(broken(Fault::kAllocate), HasSubstr("allocated or freed memory"));
    EXPECT_THAT(broken(Fault::kClock), HasSubstr("read a clock"));
    EXPECT_THAT(broken(Fault::kRandom), HasSubstr("random numbers"));
    EXPECT_THAT(broken(Fault::kRange), HasSubstr("stays in range: force() returned 1e+06 N"));
    EXPECT_THAT(broken(Fault::kNotANumber), HasSubstr("are not finite numbers"));
    EXPECT_THAT(broken(Fault::kGlobal), HasSubstr("different values from sample"));
    EXPECT_THAT(broken(Fault::kRemember), HasSubstr("depends on the trial before"));
    EXPECT_THAT(broken(Fault::kActive), HasSubstr("is passive, as it says: it gave out"));
    EXPECT_THAT(broken(Fault::kCrash), HasSubstr("crashed in sample()"));
    EXPECT_THAT(broken(Fault::kLeave), HasSubstr("exit code 0"));
    EXPECT_THAT(broken(Fault::kRefuse), HasSubstr("create()"));
    EXPECT_THAT(broken(Fault::kHang, std::chrono::milliseconds{300}),
                HasSubstr("did not return from force(); it took longer than 0.3 s"));
}

// 64 pairs of hostile input need 1.28 s, none of their calls a second.
TEST(PluginCheck, TheLimitIsOfACallAndNotOfItsRule) {
    EXPECT_EQ(broken(Fault::kSlowInCreate, std::chrono::seconds{1}, "two_ends"), "");
    const std::string hung = broken(Fault::kHangInCreate, std::chrono::milliseconds{300});
    EXPECT_THAT(hung, HasSubstr("did not return from create(); it took longer than 0.3 s"));
    EXPECT_EQ(std::count(hung.begin(), hung.end(), '\n'), 1) << "the rules behind it are not tried";
}

TEST(PluginCheck, FaultsOfTheSlavesEndAreNamedToo) {
    const auto slave = [](Fault fault) { return broken(fault, std::chrono::seconds{60}, "two_ends"); };
    EXPECT_EQ(slave(Fault::kNone), "");
    EXPECT_THAT(slave(Fault::kFar), HasSubstr("stays in range: step_slave() returned 1000 m"));
    EXPECT_THAT(slave(Fault::kEcho), HasSubstr("hostile input: with the hand at nan m"));
    EXPECT_THAT(slave(Fault::kSharedSlave), HasSubstr("the same inputs return different values from sample"));
    EXPECT_THAT(slave(Fault::kOldSlave), HasSubstr("depends on the trial before"));
}

TEST(PluginCheck, OneThatCannotBeLoadedIsOneFinding) {
    const PluginCheck check = check_plugin(plugin_file("bad_abi"));
    ASSERT_EQ(check.findings.size(), 1U);
    EXPECT_THAT(check.text(), HasSubstr("version 99"));
    EXPECT_EQ(check.exit_code(), 1);
}

}  // namespace
}  // namespace thimble::test
