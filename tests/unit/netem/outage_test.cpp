#include <gtest/gtest.h>

#include "netem/stages/slots.hpp"
#include "tests/unit/netem/link_test_tools.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(Outage, HoldsFromItsStartUntilBeforeItsEnd) {
    const std::vector<Outage> once{{.start = seconds{1}, .length = seconds{2}}};
    EXPECT_FALSE(is_out(once, seconds{1} - Duration{1}));
    EXPECT_TRUE(is_out(once, seconds{1}));
    EXPECT_TRUE(is_out(once, seconds{3} - Duration{1}));
    EXPECT_FALSE(is_out(once, seconds{3}));
    EXPECT_FALSE(is_out({}, seconds{1}));
}

TEST(Outage, ComesAgain) {
    const std::vector<Outage> handovers{
        {.start = seconds{5}, .length = milliseconds{140}, .every = seconds{15}},
        {.start = milliseconds{14'925}, .length = milliseconds{75}}};
    for (int lap = 0; lap < 1000; ++lap) {
        const Duration start = seconds{5} + lap * seconds{15};
        ASSERT_FALSE(is_out(handovers, start - Duration{1}));
        ASSERT_TRUE(is_out(handovers, start));
        ASSERT_FALSE(is_out(handovers, start + milliseconds{140}));
    }
    EXPECT_TRUE(is_out(handovers, milliseconds{14'950}));
    EXPECT_FALSE(is_out(handovers, milliseconds{29'950}));
}

// Counted from the start of the trial; what is on its way still arrives.
TEST(Outage, DropsWhatIsPushedMeanwhile) {
    LinkSettings settings{.delay = milliseconds{10}};
    settings.outages = {{.start = milliseconds{20}, .length = milliseconds{30}}};
    LinkModel link(settings, kKey, 0);
    for (const Duration start : {Duration{seconds{0}}, Duration{seconds{100}}}) {
        link.restart(kKey, at(start));
        std::vector<Arrival> arrivals;
        for (std::uint32_t i = 0; i < 100; ++i) {
            link.push(at(start + i * kMillisecond), NumberedPacket(i).bytes());
            drain(link, at(start + i * kMillisecond), arrivals);
        }
        drain(link, at(start + seconds{1}), arrivals);
        ASSERT_EQ(arrivals.size(), 70U);
        EXPECT_EQ(arrivals[19].packet, 19U);
        EXPECT_EQ(arrivals[20].packet, 50U);
        EXPECT_EQ(link.counters().outage, 30U);
    }
}

}  // namespace
}  // namespace thimble::test
