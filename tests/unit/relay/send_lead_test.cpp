// The work that may begin before a due time, and the number of datagrams per read of a socket.
#include "netem/relay/send_lead.hpp"

#include <gtest/gtest.h>

#include "netem/relay/datagram_batch.hpp"

namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::nanoseconds;

TEST(LeastLately, IsZeroUntilEnoughIsKnown) {
    LeastLately least;
    for (int i = 0; i < 63; ++i) least.add(nanoseconds{700});
    EXPECT_EQ(least.least(), Duration::zero());
    least.add(nanoseconds{900});
    EXPECT_EQ(least.least(), nanoseconds{700});
}

TEST(LeastLately, FollowsAShorterOneAtOnceAndForgetsItAfterTwoGenerations) {
    LeastLately least;
    const auto add = [&](int times, Duration took) {
        for (int i = 0; i < times; ++i) least.add(took);
    };
    add(64, nanoseconds{700});
    least.add(nanoseconds{300});
    EXPECT_EQ(least.least(), nanoseconds{300});
    add(63 + 64, nanoseconds{800});
    EXPECT_EQ(least.least(), nanoseconds{300});
    add(64, nanoseconds{800});
    EXPECT_EQ(least.least(), nanoseconds{800});
}

TEST(SendCost, IsNoMoreThanACallTakes) {
    const Duration cost = measure_send_cost();
    EXPECT_GE(cost, Duration::zero());
    EXPECT_LT(cost, microseconds{100});
}

TEST(ReceiveTurn, AsksForOneWhereOneComes) {
    ReceiveTurn turn;
    for (int i = 0; i < 100; ++i) {
        EXPECT_LE(turn.most(), 2U);
        turn.got(1);
    }
}

TEST(ReceiveTurn, AsksForAllThatFitWhereManyCome) {
    ReceiveTurn turn;
    for (int i = 0; i < 40; ++i) turn.got(turn.most());
    EXPECT_EQ(turn.most(), ReceiveBatch::kSize);
    turn.got(0);
    EXPECT_EQ(turn.most(), ReceiveBatch::kSize / 2);
    for (int i = 0; i < 10; ++i) turn.got(0);
    EXPECT_EQ(turn.most(), 1U);
}

}  // namespace
}  // namespace thimble
