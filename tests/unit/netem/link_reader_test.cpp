#include "netem/link_reader.hpp"

#include <string>

#include <gtest/gtest.h>

#include "common/error.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

LinkSettings read(const std::string& text) {
    const ConfigFile file = ConfigFile::parse("[link]\n" + text, "link.toml");
    const LinkSettings link = read_link_settings(file.table("link"));
    file.finish();
    return link;
}

// The message of the refusal, empty if there was none.
std::string refusal(const std::string& text) {
    try {
        read(text);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kUsage);
        return error.what();
    }
    return {};
}

TEST(LinkSettings, DefaultIsAnIdealLink) {
    const LinkSettings link = read("");
    EXPECT_EQ(link.delay, Duration::zero());
    EXPECT_EQ(link.jitter.shape, JitterShape::kNone);
    EXPECT_EQ(link.loss, LossSettings::independent(0));
    EXPECT_TRUE(link.in_order);
    EXPECT_EQ(link.capacity, 4096U);
}

TEST(LinkSettings, ReadsEveryKey) {
    const LinkSettings link = read(
        "delay_s = 0.05\njitter = \"normal\"\njitter_spread_s = 0.005\nloss = 0.01\nin_order = false\n"
        "capacity = 100");
    EXPECT_EQ(link.delay, milliseconds{50});
    EXPECT_EQ(link.jitter.shape, JitterShape::kNormal);
    EXPECT_EQ(link.jitter.spread, milliseconds{5});
    EXPECT_EQ(link.loss, LossSettings::independent(0.01));
    EXPECT_FALSE(link.in_order);
    EXPECT_EQ(link.capacity, 100U);
    EXPECT_EQ(read("jitter = \"uniform\"\ndelay_s = 1\njitter_spread_s = 1").jitter.shape,
              JitterShape::kUniform);
}

TEST(LinkSettings, RefusesWhatIsOutOfRange) {
    EXPECT_NE(refusal("delay_s = -0.001").find("delay_s"), std::string::npos);
    EXPECT_NE(refusal("delay_s = 60.1").find("delay_s"), std::string::npos);
    EXPECT_NE(refusal("loss = 1.01").find("loss"), std::string::npos);
    EXPECT_NE(refusal("jitter = \"pareto\"").find("uniform"), std::string::npos);
    EXPECT_NE(refusal("capacity = 0").find("capacity"), std::string::npos);
    EXPECT_NE(refusal("delay_ms = 50").find("delay_ms"), std::string::npos);
}

TEST(LinkSettings, RefusesWhatContradictsItself) {
    EXPECT_NE(refusal("delay_s = 0.05\njitter_spread_s = 0.01").find("distribution"), std::string::npos);
    EXPECT_NE(refusal("delay_s = 0.05\njitter = \"normal\"").find("above 0"), std::string::npos);
    const std::string uniform = "delay_s = 0.05\njitter = \"uniform\"\njitter_spread_s = ";
    EXPECT_EQ(refusal(uniform + "0.05"), "");
    EXPECT_NE(refusal(uniform + "0.051").find("cut at 0"), std::string::npos);
    const std::string normal = "delay_s = 0.05\njitter = \"normal\"\njitter_spread_s = ";
    EXPECT_EQ(refusal(normal + "0.025"), "");
    EXPECT_NE(refusal(normal + "0.026").find("cut at 0"), std::string::npos);
}

TEST(LinkSettings, CapacityMustHoldTheDelay) {
    EXPECT_NE(refusal("delay_s = 0.05\ncapacity = 50").find("51 packets"), std::string::npos);
    EXPECT_EQ(refusal("delay_s = 0.05\ncapacity = 51"), "");
    EXPECT_GE(read("delay_s = 60").capacity, 120'000U);
}

}  // namespace
}  // namespace thimble
