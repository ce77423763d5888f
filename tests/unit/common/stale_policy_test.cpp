#include "common/stale_policy.hpp"

#include <string>

#include <gtest/gtest.h>

#include "common/error.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

StalePolicy stale_policy(const std::string& text) {
    const ConfigFile file = ConfigFile::parse("[master]\n" + text, "stale.toml");
    const StalePolicy policy =
        read_stale_policy(file.table("master"), StalePolicy{StaleMode::kRamp}, milliseconds{1}, seconds{1});
    file.finish();
    return policy;
}

TEST(StalePolicy, EachModeInTime) {
    const StalePolicy hold{StaleMode::kHold}, ramp{StaleMode::kRamp}, zero{StaleMode::kZero};
    for (const StalePolicy& policy : {hold, ramp, zero}) {
        EXPECT_EQ(policy.share(milliseconds{-5}), 1);
        EXPECT_EQ(policy.share(milliseconds{99}), 1);
    }
    EXPECT_EQ(hold.share(seconds{3}), 1);
    EXPECT_EQ(zero.share(milliseconds{100}), 0);
    EXPECT_EQ(ramp.share(milliseconds{100}), 1);
    EXPECT_DOUBLE_EQ(ramp.share(milliseconds{105}), 0.75);
    EXPECT_DOUBLE_EQ(ramp.share(milliseconds{110}), 0.5);
    EXPECT_EQ(ramp.share(milliseconds{120}), 0);
    EXPECT_EQ(ramp.share(seconds{9}), 0);
    const StalePolicy at_once{StaleMode::kRamp, milliseconds{10}, milliseconds{0}};
    EXPECT_EQ(at_once.share(milliseconds{10}), 0) << "a ramp of no length";
}

TEST(StalePolicy, IsReadAndSaidInWords) {
    EXPECT_EQ(stale_policy("").text(), "ramp to zero within 20 ms after 100 ms");
    EXPECT_EQ(stale_policy("stale = 'hold'\nstale_after_s = 0.05").text(), "hold after 50 ms");
    EXPECT_EQ(stale_policy("stale = 'zero'").text(), "zero after 100 ms");
    EXPECT_EQ(stale_policy("stale_ramp_s = 0.2").text(), "ramp to zero within 200 ms after 100 ms");
}

TEST(StalePolicy, RefusesWhatMakesNoSense) {
    for (const char* text : {"stale = 'stop'", "stale = 1", "stale_after_s = 0", "stale_ramp_s = -1",
                             "stale = 'zero'\nstale_ramp_s = 0.1", "stale_s = 1"}) {
        EXPECT_THROW(stale_policy(text), Error) << text;
    }
}

}  // namespace
}  // namespace thimble
