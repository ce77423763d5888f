#include "common/runtime/wait_margin.hpp"

#include <gtest/gtest.h>

namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

SessionTime at_ms(std::int64_t ms) { return SessionTime{milliseconds{ms}}; }

// Of 512 latenesses, as many us late as `late_us` says of each; then the margin.
TEST(WaitMargin, CoversAllButTheTwoWorstOfTheLastThatAreNoStalls) {
    struct Case {
        const char* name;
        int (*late_us)(int i);
        int margin_us;
    };
    WaitMargin margin;
    for (const Case& c :
         {Case{"two worst", [](int i) { return i == 100 || i == 300 ? 150 : 20; }, 20},
          Case{"three worst", [](int i) { return i % 170 == 0 ? 150 : 20; }, 150},
          Case{"all late", [](int) { return 90; }, 90}, Case{"long ago", [](int) { return 7; }, 7},
          Case{"stalls", [](int i) { return i % 2 == 0 ? 9000 : 12; }, 12}}) {
        for (int i = 0; i < 512; ++i) margin.add(microseconds{c.late_us(i)});
        EXPECT_EQ(margin.margin(), microseconds{c.margin_us}) << c.name;
    }
}

TEST(WaitMargin, IsNeverNothing) {
    WaitMargin margin;
    EXPECT_GE(margin.margin(), microseconds{50}) << "before the timer is known";
    for (int i = 0; i < 512; ++i) margin.add(Duration::zero());
    EXPECT_GE(margin.margin(), microseconds{2});
}

TEST(SpinBudget, AllowsFourFifthsOfATenthOfASecond) {
    SpinBudget budget;
    EXPECT_EQ(budget.left(at_ms(1000)), milliseconds{80});
    budget.spent(at_ms(1030), milliseconds{30});
    budget.spent(at_ms(1080), milliseconds{50});
    EXPECT_LE(budget.left(at_ms(1080)), Duration::zero());
}

TEST(SpinBudget, ComesBackAsTimePasses) {
    SpinBudget budget;
    budget.spent(at_ms(1010), milliseconds{10});
    budget.spent(at_ms(1090), milliseconds{70});
    EXPECT_EQ(budget.left(at_ms(1100)), Duration::zero());
    EXPECT_EQ(budget.left(at_ms(1125)), milliseconds{10}) << "the first spell is more than 100 ms ago";
    EXPECT_EQ(budget.left(at_ms(1210)), milliseconds{80});
    EXPECT_EQ(budget.left(at_ms(100000)), milliseconds{80});
}

// A thread that spins whenever it may never exceeds the share in any window.
TEST(SpinBudget, HoldsInEveryWindow) {
    SpinBudget budget;
    std::vector<int> spun(2000, 0);
    for (int ms = 0; ms < 2000; ++ms) {
        if (budget.left(at_ms(1000 + ms)) < milliseconds{1}) continue;
        spun[static_cast<std::size_t>(ms)] = 1;
        budget.spent(at_ms(1000 + ms + 1), milliseconds{1});
    }
    int total = 0;
    for (std::size_t start = 0; start + 100 <= spun.size(); ++start) {
        int sum = 0;
        for (std::size_t i = start; i < start + 100; ++i) sum += spun[i];
        EXPECT_LE(sum, 80) << "from " << start;
        total = std::max(total, sum);
    }
    EXPECT_GE(total, 70) << "and it may spin most of the time";
}

}  // namespace
}  // namespace thimble
