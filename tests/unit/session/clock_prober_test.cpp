// Offsets over a window and rates over a session: the truth is never outside, and the bounds are no wider than needed.
#include "session/clocks/clock_prober.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "session/clocks/clock_line.hpp"
#include "session/clocks/clock_summary.hpp"

namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

// A far clock that is what it says, to the nanosecond.
struct FarClock {
    Duration offset{};
    int ppm = 0;
    SessionTime at(SessionTime near) const {
        return near + offset + Duration{near.time_since_epoch().count() / 1'000'000 * ppm};
    }
    double offset_s(SessionTime near) const { return to_seconds(at(near) - near); }
};

ClockExchange exchange(const FarClock& clock, SessionTime sent, Duration there, Duration back) {
    const SessionTime far = clock.at(sent + there);
    return {sent, far, far, sent + there + back};
}

bool contains(const OffsetInterval& interval, double truth_s, double slack_s = 2e-9) {
    return interval.low_s - slack_s <= truth_s && truth_s <= interval.high_s + slack_s;
}

TEST(ClockFilter, TheTightestExchangeOfTheWindowCounts) {
    const FarClock clock{seconds{3}};
    ClockFilter filter;
    EXPECT_FALSE(filter.at(SessionTime{seconds{1}})) << "before the first exchange";
    filter.add(exchange(clock, SessionTime{seconds{1}}, microseconds{100}, microseconds{100}));
    const SessionTime last{seconds{1} + milliseconds{100}};
    filter.add(exchange(clock, last, milliseconds{5}, milliseconds{9}));
    const auto offset = filter.at(last + milliseconds{14});
    ASSERT_TRUE(offset);
    EXPECT_TRUE(contains(*offset, 3));
    EXPECT_LT(offset->bound_s(), 0.0003);  // not 7 ms: 0.1 ms, and what 114 ms of drift may add
    EXPECT_GT(offset->bound_s(), 0.0001);
}

// Each of the two knows one side only; together they know both.
TEST(ClockFilter, IntersectionIsTighterThanItsBestMember) {
    const FarClock clock{milliseconds{-40}};
    ClockFilter filter;
    filter.add(exchange(clock, SessionTime{seconds{1}}, microseconds{10}, milliseconds{8}));
    filter.add(
        exchange(clock, SessionTime{seconds{1} + milliseconds{20}}, milliseconds{8}, microseconds{10}));
    const auto offset = filter.at(SessionTime{seconds{1} + milliseconds{30}});
    EXPECT_TRUE(contains(*offset, -0.040));
    EXPECT_LT(offset->bound_s(), 0.0001);
}

TEST(ClockFilter, AStepIsCountedAndForgotten) {
    for (const Duration step : {Duration{milliseconds{50}}, Duration{milliseconds{-50}}}) {
        FarClock clock{seconds{3}};
        ClockFilter filter;
        SessionTime now{seconds{1}};
        for (int i = 0; i < 20; ++i, now += milliseconds{200}) {
            if (i == 10) clock.offset += step;
            EXPECT_EQ(filter.add(exchange(clock, now, milliseconds{10}, milliseconds{20})), i != 10);
            EXPECT_TRUE(contains(*filter.at(now + milliseconds{30}), clock.offset_s(now)));
        }
        EXPECT_EQ(filter.steps(), 1U);
    }
}

TEST(ClockFilter, DriftIsNoStep) {
    const FarClock clock{{}, 400};
    ClockFilter filter;
    for (int i = 0; i < 1000; ++i) {
        filter.add(exchange(clock, SessionTime{milliseconds{200 * i}}, microseconds{2}, microseconds{2}));
    }
    EXPECT_EQ(filter.steps(), 0U);
}

// The clocks may move apart during an exchange: the bound that the request gives is as old as the whole exchange.
TEST(ClockFilter, ALongExchangeKeepsRoomForItsDrift) {
    const seconds trip{10}, later{2};
    for (const bool slow_reply : {true, false}) {
        for (const int ppm : {900, -900}) {
            const FarClock clock{seconds{3}, ppm};
            const ClockExchange e = exchange(clock, SessionTime{seconds{100}}, slow_reply ? seconds{0} : trip,
                                             slow_reply ? trip : seconds{0});
            ClockFilter filter;
            EXPECT_TRUE(filter.add(e));
            const OffsetInterval then = filter.at(e.answered).value();
            EXPECT_TRUE(contains(then, clock.offset_s(e.answered))) << slow_reply << " " << ppm;
            EXPECT_NEAR(then.low_s, to_seconds(e.low()), 1e-12);
            EXPECT_NEAR(then.high_s, to_seconds(e.high()) + kClockRateLimit * 10, 1e-12);
            const OffsetInterval now = filter.at(e.answered + later).value();
            EXPECT_TRUE(contains(now, clock.offset_s(e.answered + later))) << slow_reply << " " << ppm;
            EXPECT_NEAR(now.low_s, to_seconds(e.low()) - kClockRateLimit * 2, 1e-12);
            EXPECT_NEAR(now.high_s, to_seconds(e.high()) + kClockRateLimit * 12, 1e-12);
        }
    }
}

// The clock drifts by 9 ms during the slow exchange, and the quick one after it shows that.
TEST(ClockFilter, DriftDuringALongExchangeIsNoStep) {
    for (const int ppm : {900, -900}) {
        const FarClock clock{seconds{3}, ppm};
        ClockFilter filter;
        filter.add(exchange(clock, SessionTime{seconds{100}}, seconds{0}, seconds{10}));
        EXPECT_TRUE(filter.add(exchange(clock, SessionTime{seconds{110}}, microseconds{1}, microseconds{1})));
        filter.add(exchange(clock, SessionTime{seconds{120}}, seconds{10}, seconds{0}));
        EXPECT_TRUE(filter.add(exchange(clock, SessionTime{seconds{130}}, microseconds{1}, microseconds{1})));
        EXPECT_EQ(filter.steps(), 0U);
    }
}

std::vector<ClockExchange> draw_exchanges(const FarClock& clock) {
    std::vector<ClockExchange> exchanges;
    const int count = *rc::gen::inRange(1, 60);
    std::int64_t now_us = 0;
    for (int i = 0; i < count; ++i) {
        now_us += *rc::gen::inRange(1000, 400'000);
        exchanges.push_back(exchange(clock, SessionTime{microseconds{now_us}},
                                     microseconds{*rc::gen::inRange(0, 50'000)},
                                     microseconds{*rc::gen::inRange(0, 50'000)}));
    }
    return exchanges;
}

FarClock draw_clock() {
    return {microseconds{*rc::gen::inRange<std::int64_t>(1, 100'000'000'000)}, *rc::gen::inRange(-300, 300)};
}

TEST(ClockFilterProperties, TheTruthIsInsideWhateverTheDelays) {
    EXPECT_TRUE(rc::check([] {
        const FarClock clock = draw_clock();
        ClockFilter filter;
        for (const ClockExchange& e : draw_exchanges(clock)) {
            filter.add(e);
            RC_ASSERT(contains(*filter.at(e.answered), clock.offset_s(e.answered)));
            RC_ASSERT(filter.at(e.answered)->bound_s() <= e.bound_s() + 1e-3 * to_seconds(e.round_trip()));
        }
        RC_ASSERT(filter.steps() == 0U);
    }));
}

TEST(ClockLineProperties, TheTrueLineIsPossibleAndTheBoundsAreAttained) {
    EXPECT_TRUE(rc::check([] {
        const FarClock clock = draw_clock();
        const auto exchanges = draw_exchanges(clock);
        const auto line = ClockLine::fit(exchanges);
        RC_ASSERT(line.has_value());
        const double slack = 1e-9;
        RC_ASSERT(line->rate_low() - slack <= 1e-6 * clock.ppm);
        RC_ASSERT(1e-6 * clock.ppm <= line->rate_high() + slack);
        for (const ClockExchange& e : exchanges)
            RC_ASSERT(contains(line->at(e.sent), clock.offset_s(e.sent), 1e-7));
        // The same from all pairs, without hulls.
        double low = -kClockRateLimit, high = kClockRateLimit;
        for (const ClockExchange& a : exchanges) {
            for (const ClockExchange& b : exchanges) {
                const double room_s = to_seconds(b.high() - a.low()),
                             apart_s = to_seconds(b.sent - a.answered);
                if (apart_s > 0) high = std::min(high, room_s / apart_s);
                if (apart_s < 0) low = std::max(low, room_s / apart_s);
            }
        }
        const auto near = [](double a, double b) {
            return a == b || std::abs(a - b) <= 1e-9 * (1 + std::abs(b));
        };
        RC_ASSERT(near(line->rate_low(), low));
        RC_ASSERT(near(line->rate_high(), high));
    }));
}

TEST(ClockLine, NoLinePassesThroughAStep) {
    const FarClock before{seconds{1}}, after{seconds{2}};
    std::vector<ClockExchange> exchanges;
    for (int i = 0; i < 10; ++i) {
        exchanges.push_back(
            exchange(i < 5 ? before : after, SessionTime{seconds{i + 1}}, milliseconds{1}, milliseconds{1}));
    }
    EXPECT_FALSE(ClockLine::fit(exchanges));
    const ClockSummary summary = summarize_clock(exchanges);
    EXPECT_EQ(summary.steps, 1U);
    EXPECT_TRUE(summary.even);  // since then
    EXPECT_TRUE(contains(*summary.offset, 2));
}

TEST(ClockLine, LongSessionsKnowTheRateWell) {
    const FarClock clock{seconds{86400}, 50};
    std::vector<ClockExchange> exchanges;
    for (int i = 0; i < 3000; ++i) {
        exchanges.push_back(exchange(clock, SessionTime{milliseconds{200 * i}}, microseconds{40 + i % 7},
                                     microseconds{35 + i % 11}));
    }
    const ClockSummary summary = summarize_clock(exchanges);
    ASSERT_TRUE(summary.even);
    EXPECT_LE(summary.rate_low, 50e-6);
    EXPECT_GE(summary.rate_high, 50e-6);
    EXPECT_LT(summary.rate_high - summary.rate_low, 0.5e-6);  // 75 us of round trip twice in 600 s
    EXPECT_GT(summary.rate_high - summary.rate_low, 0.1e-6);
}

TEST(ClockSummary, OneWayDelaysAreShownWhereTheyAreKnown) {
    const FarClock clock{seconds{5}};
    std::vector<ClockExchange> exchanges;
    // One quick exchange pins the offset to 50 us; all others take 20 ms there and 30 ms back.
    exchanges.push_back(exchange(clock, SessionTime{seconds{1}}, microseconds{50}, microseconds{50}));
    for (int i = 0; i < 50; ++i) {
        exchanges.push_back(exchange(clock, SessionTime{seconds{1} + milliseconds{1 + i}}, milliseconds{20},
                                     milliseconds{30}));
    }
    const ClockSummary pinned = summarize_clock(exchanges);
    ASSERT_TRUE(pinned.there && pinned.back);
    EXPECT_TRUE(pinned.there->known());
    EXPECT_NEAR(pinned.there->median_s, 0.020, pinned.there->bound_s);
    EXPECT_NEAR(pinned.back->median_s, 0.030, pinned.back->bound_s);
    // Without it the division of 50 ms is unknown.
    exchanges.erase(exchanges.begin());
    const ClockSummary blind = summarize_clock(exchanges);
    EXPECT_FALSE(blind.there->known() && blind.back->known());
    EXPECT_NEAR(blind.there->median_s, 0.020, blind.there->bound_s);
    EXPECT_GE(blind.there->bound_s, 0.0249);
}

// Which replies count, and what a single exchange proves.
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
