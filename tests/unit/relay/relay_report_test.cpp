#include "netem/relay/relay_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace thimble {
namespace {

// Against R: prop.test(10, 100, correct = FALSE)$conf.int, and so on.
TEST(Wilson, IsTheScoreInterval) {
    const ProportionInterval ten = wilson_95(10, 100);
    EXPECT_NEAR(ten.low, 0.05522914, 1e-8);
    EXPECT_NEAR(ten.high, 0.1743657, 1e-7);
    const ProportionInterval none = wilson_95(0, 3200);
    EXPECT_EQ(none.low, 0);
    EXPECT_NEAR(none.high, 3.8414588 / (3200 + 3.8414588), 1e-9);
    EXPECT_EQ(wilson_95(5, 5).high, 1);
    EXPECT_EQ(wilson_95(0, 0).low, 0);
    EXPECT_EQ(wilson_95(0, 0).high, 1);
}

TEST(RelayReport, SaysAskedAndAchieved) {
    RelayState state;
    state.links.up.delay = std::chrono::milliseconds{50};
    state.links.up.loss = LossSettings::independent(0.25);
    DirectionTotals& up = state.totals.direction[0];
    up.packets.pushed = 14;  // of which the loss model could have taken 4
    up.packets.outage = 8;
    up.packets.oversized = 2;
    up.packets.lost = 1;
    up.packets.delivered = 3;
    up.refused = 1;
    for (int i = 0; i < 2; ++i) {
        up.delay.add(std::chrono::microseconds{50'020});
        up.error.add(std::chrono::microseconds{20});
    }
    const auto json = describe(state);
    EXPECT_EQ(json.at("up").at("packets").at("sent"), 2);
    EXPECT_EQ(json.at("up").at("packets").at("refused_by_kernel"), 1);
    EXPECT_DOUBLE_EQ(json.at("up").at("loss").at("asked").get<double>(), 0.25);
    EXPECT_DOUBLE_EQ(json.at("up").at("loss").at("achieved").get<double>(), 0.25);
    EXPECT_NEAR(json.at("up").at("due_time_error").at("median_us").get<double>(), 20, 0.1);
    const std::string words = report_text(json);
    for (const char* said : {"asked 50 ms", "asked 25 %", "1 refused_by_kernel"})
        EXPECT_THAT(words, testing::HasSubstr(said));
    EXPECT_EQ(describe(RelayState{}).at("up").at("loss").at("achieved"), 0);
}

}  // namespace
}  // namespace thimble
