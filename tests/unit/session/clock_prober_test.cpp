// Which replies count, and what a single exchange proves.
#include "session/clocks/clock_prober.hpp"

#include <gtest/gtest.h>

namespace thimble {
namespace {

using std::chrono::milliseconds;

constexpr SessionTime at_ms(int ms) { return SessionTime{milliseconds{ms}}; }

TEST(ClockExchange, TheClassicalOffsetAndBound) {
    // Far clock 1000 ms ahead; 10 ms there, 2 ms held, 30 ms back.
    const ClockExchange e{at_ms(100), at_ms(1110), at_ms(1112), at_ms(142)};
    EXPECT_TRUE(e.possible());
    EXPECT_DOUBLE_EQ(e.offset_s(), 0.990);
    EXPECT_DOUBLE_EQ(e.bound_s(), 0.020);
    EXPECT_EQ(e.round_trip(), milliseconds{42});
}

TEST(ClockExchange, ANoteTakenLateWidensTheBoundOnly) {
    ClockExchange e{at_ms(100), at_ms(1110), at_ms(1110), at_ms(140)};
    e.arrived += milliseconds{5};
    EXPECT_TRUE(e.possible());
    EXPECT_DOUBLE_EQ(e.bound_s(), 0.0225);
    EXPECT_LE(to_seconds(e.low()), 1);
    EXPECT_GE(to_seconds(e.high()), 1);
}

TEST(ClockExchange, DifferencesOfTwoNodesAddTheirBounds) {
    const OffsetInterval a{1.0, 1.2}, b{-0.5, -0.1};
    EXPECT_DOUBLE_EQ(between(a, b).offset_s(), 1.4);
    EXPECT_DOUBLE_EQ(between(a, b).bound_s(), a.bound_s() + b.bound_s());
}

TEST(ClockProber, ProbesWhenDue) {
    ClockProber prober;
    EXPECT_TRUE(prober.due(at_ms(5)));
    EXPECT_EQ(prober.probe(at_ms(5)).send_time, at_ms(5));
    EXPECT_FALSE(prober.due(at_ms(204)));
    EXPECT_TRUE(prober.due(at_ms(205)));
}

TEST(ClockProber, AReplyCountsOnce) {
    ClockProber prober;
    prober.probe(at_ms(5));
    const ClockReply reply{at_ms(5), at_ms(9000)};
    const auto exchange = prober.take(reply, at_ms(9001), at_ms(25));
    ASSERT_TRUE(exchange);
    EXPECT_EQ(exchange->sent, at_ms(5));
    EXPECT_EQ(exchange->arrived, at_ms(9000));
    EXPECT_EQ(exchange->replied, at_ms(9001));
    EXPECT_EQ(exchange->answered, at_ms(25));
    EXPECT_FALSE(prober.take(reply, at_ms(9001), at_ms(26)));  // replayed
    EXPECT_EQ(prober.counters().exchanges, 1U);
    EXPECT_EQ(prober.counters().unmatched, 1U);
}

TEST(ClockProber, RepliesMayOvertakeEachOther) {
    ClockProber prober;
    prober.probe(at_ms(0));
    prober.probe(at_ms(200));
    EXPECT_TRUE(prober.take({at_ms(200), at_ms(210)}, at_ms(210), at_ms(220)));
    EXPECT_TRUE(prober.take({at_ms(0), at_ms(10)}, at_ms(10), at_ms(230)));
}

TEST(ClockProber, AForgedReplyMatchesNoProbe) {
    ClockProber prober;
    EXPECT_FALSE(prober.take({kNever, at_ms(1)}, at_ms(1), at_ms(1)));  // nothing was asked yet
    prober.probe(at_ms(5));
    EXPECT_FALSE(prober.take({at_ms(6), at_ms(9)}, at_ms(9), at_ms(10)));
    EXPECT_FALSE(prober.take({kNever, at_ms(9)}, at_ms(9), at_ms(10)));
    EXPECT_EQ(prober.counters().unmatched, 3U);
    EXPECT_TRUE(prober.take({at_ms(5), at_ms(9)}, at_ms(9), at_ms(10)));  // the true one still counts
}

TEST(ClockProber, ImpossibleStampsAreRefused) {
    ClockProber prober;
    prober.probe(at_ms(5));
    // Held for 100 ms within a round trip of 5 ms.
    EXPECT_FALSE(prober.take({at_ms(5), at_ms(0)}, at_ms(100), at_ms(10)));
    EXPECT_EQ(prober.counters().impossible, 1U);
    prober.probe(at_ms(205));
    EXPECT_FALSE(prober.take({at_ms(205), at_ms(5)}, at_ms(5), at_ms(204)));  // before it was asked
    EXPECT_EQ(prober.counters().impossible, 2U);
}

TEST(ClockProber, AProbeThatNobodyAnsweredIsForgotten) {
    ClockProber prober;
    for (int i = 0; i < 17; ++i) prober.probe(at_ms(200 * i));
    EXPECT_FALSE(prober.take({at_ms(0), at_ms(1)}, at_ms(1), at_ms(3500)));
    EXPECT_TRUE(prober.take({at_ms(200), at_ms(1)}, at_ms(1), at_ms(3500)));
}

}  // namespace
}  // namespace thimble
