// Orders: each request once, and none for a trial that is over.
#include "session/play/order_taker.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "common/queue_channel.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class WritesDown final : public OrderHandler {
  public:
    std::optional<Refusal> obey(SessionTime, const Order& order) override {
        orders.push_back(order);
        return answer;
    }
    std::vector<Order> orders;
    std::optional<Refusal> answer;
};

class OrderTakerTest : public testing::Test {
  protected:
    // As a view says it: for the trial that it saw.
    void say(OrderKind kind, std::uint32_t seen_trial, std::uint32_t which = 0, double value = 0) {
        Order order;
        order.kind = kind;
        order.trial = which;
        order.value = value;
        view.send(now, seen_trial, order);
        taker.tick(now, trial);
    }
    std::uint64_t refused(Refusal refusal) const { return taker.counters().of(refusal); }

    QueuePipe pipe;
    WritesDown handler;
    OutboundFlow view{Role::kExperimenter, 9, {&pipe.a}};
    OrderTaker taker{pipe.b, handler};
    SessionTime now = at(seconds{3});
    std::uint32_t trial = 4;
};

TEST_F(OrderTakerTest, HandsOnWhatItHears) {
    say(OrderKind::kDelay, 4, 0, 0.25);
    say(OrderKind::kPause, 4);
    ASSERT_EQ(handler.orders.size(), 2U);
    EXPECT_EQ(handler.orders[0].value, 0.25);
    EXPECT_EQ(handler.orders[1].kind, OrderKind::kPause);
    EXPECT_EQ(taker.counters().accepted, 2U);
}

TEST_F(OrderTakerTest, AStartOrEndThatWasAskedForAnotherTrialIsTooLate) {
    say(OrderKind::kStart, 3);
    say(OrderKind::kEndTrial, 3);
    EXPECT_TRUE(handler.orders.empty());
    EXPECT_EQ(refused(Refusal::kWrongTrial), 2U);
    say(OrderKind::kStart, 4);
    say(OrderKind::kStart, 4);  // said again: harmless, the trial has not begun
    trial = 5;
    say(OrderKind::kStart, 4);  // and again when it has
    EXPECT_EQ(handler.orders.size(), 2U);
    EXPECT_EQ(refused(Refusal::kWrongTrial), 3U);
}

TEST_F(OrderTakerTest, ARepeatSaidFiveTimesIsOneWish) {
    for (int i = 0; i < 5; ++i) {
        say(OrderKind::kRepeat, 4, 4);
        now += milliseconds{50};
    }
    EXPECT_EQ(handler.orders.size(), 1U);
    say(OrderKind::kExclude, 4, 4);
    EXPECT_EQ(handler.orders.size(), 2U);
    now += seconds{2};
    say(OrderKind::kRepeat, 4, 4);  // pressed again
    EXPECT_EQ(handler.orders.size(), 3U);
    trial = 5;
    say(OrderKind::kRepeat, 5, 5);
    EXPECT_EQ(handler.orders.size(), 4U);
}

TEST_F(OrderTakerTest, OnlyTheNewestTrialCanBeJudged) {
    say(OrderKind::kRepeat, 4, 2);
    say(OrderKind::kExclude, 4, 0);
    EXPECT_TRUE(handler.orders.empty());
    EXPECT_EQ(refused(Refusal::kWrongTrial), 2U);
}

TEST_F(OrderTakerTest, WhatTheHandlerRefusesIsCountedByItsReason) {
    handler.answer = Refusal::kOutOfRange;
    say(OrderKind::kDelay, 4, 0, 500);
    EXPECT_EQ(refused(Refusal::kOutOfRange), 1U);
    EXPECT_EQ(taker.counters().accepted, 0U);
}

TEST_F(OrderTakerTest, OthersAreNotHeard) {
    OutboundFlow visual(Role::kVisual, 10, {&pipe.a});
    visual.send(now, 4, Order{});
    view.send(now, 4, Heartbeat{});
    taker.tick(now, trial);
    EXPECT_TRUE(handler.orders.empty());
    EXPECT_EQ(refused(Refusal::kUnexpectedKind), 2U);
}

}  // namespace
}  // namespace thimble
