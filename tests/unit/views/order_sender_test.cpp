#include "visual_node/views/order_sender.hpp"

#include <utility>

#include <gtest/gtest.h>

#include "tests/unit/views/played_session.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

Order order_of(OrderKind kind, double value = 0, Modality modality = Modality::kHF) {
    return {.value = value, .kind = kind, .modality = modality};
}

struct OrderBench {
    PlayedViewSession session;
    OrderSender sender{5, *session.channels().orders_out};
    SessionView view{{}, 3, false};

    void ask(Duration when, const Order& order) { sender.ask(at(when), order, view); }
    // Updates each millisecond, ends included.
    void run(int from_ms, int to_ms) {
        for (int ms = from_ms; ms <= to_ms; ++ms) sender.update(at(milliseconds{ms}), view);
    }
    std::vector<HeardOrder> heard() { return session.heard(at(std::chrono::seconds{10})); }
};

TEST(OrderSender, SaysItAtOnceAndEvery50MsUntilItShows) {
    OrderBench bench;
    bench.ask(milliseconds{100}, order_of(OrderKind::kDelay, 0.05));
    bench.run(100, 260);
    auto heard = bench.heard();
    ASSERT_EQ(heard.size(), 4U);
    for (std::size_t i = 0; i < heard.size(); ++i) {
        EXPECT_EQ(heard[i].at, at(milliseconds{100} + i * kOrderRepeat));
        EXPECT_EQ(heard[i].order.value, 0.05);
        EXPECT_EQ(heard[i].trial, 3U);
    }
    EXPECT_EQ(bench.sender.progress(OrderKind::kDelay), OrderProgress::kAsking);
    bench.view.monitor.network_delay_s = 0.05;
    bench.run(261, 2500);
    EXPECT_TRUE(bench.heard().empty());
    EXPECT_EQ(bench.sender.progress(OrderKind::kDelay), OrderProgress::kShown);
    EXPECT_FALSE(bench.sender.asking());
}

// A pause cancels a waiting request to resume, and the other way round.
TEST(OrderSender, AnOrderCallsItsOppositeOff) {
    for (const auto& [first, second] : {std::pair{OrderKind::kPause, OrderKind::kResume},
                                        std::pair{OrderKind::kStart, OrderKind::kEndTrial},
                                        std::pair{OrderKind::kDelay, OrderKind::kNetwork}}) {
        for (const bool swapped : {false, true}) {
            OrderBench bench;
            bench.ask(milliseconds{100}, order_of(swapped ? second : first));
            bench.ask(milliseconds{110}, order_of(swapped ? first : second));
            EXPECT_EQ(bench.sender.progress(swapped ? second : first), OrderProgress::kNone);
            EXPECT_EQ(bench.sender.progress(swapped ? first : second), OrderProgress::kAsking);
        }
    }
}

TEST(OrderSender, AfterTwoSecondsItSaysThatNobodyAnswers) {
    OrderBench bench;
    bench.ask(milliseconds{0}, order_of(OrderKind::kPause));
    bench.run(0, 1999);
    EXPECT_EQ(bench.sender.unanswered(), nullptr);
    bench.run(2000, 2000);
    ASSERT_NE(bench.sender.unanswered(), nullptr);
    EXPECT_EQ(bench.sender.unanswered()->kind, OrderKind::kPause);
    EXPECT_EQ(bench.heard().size(), 40U);
    bench.run(2001, 3000);
    EXPECT_TRUE(bench.heard().empty());
    bench.ask(milliseconds{3001}, order_of(OrderKind::kPause));
    EXPECT_EQ(bench.sender.unanswered(), nullptr);
    bench.view.monitor.paused = bench.view.silent = true;  // what a silent session last said proves nothing
    bench.run(3001, 5001);
    EXPECT_EQ(bench.sender.progress(OrderKind::kPause), OrderProgress::kUnanswered);
}

TEST(OrderSender, AnOldMonitorDoesNotEndAnOrderBeforeItCanHaveBeenHeard) {
    OrderBench bench;  // shows 0 s already; the order is said once nevertheless
    bench.ask(milliseconds{0}, order_of(OrderKind::kDelay, 0));
    bench.run(0, 49);
    EXPECT_EQ(bench.sender.progress(OrderKind::kDelay), OrderProgress::kAsking);
    bench.run(50, 50);
    EXPECT_EQ(bench.sender.progress(OrderKind::kDelay), OrderProgress::kShown);
    EXPECT_EQ(bench.heard().size(), 1U);
}

TEST(OrderSender, EachKindHasItsOwnProof) {
    OrderBench bench;
    Monitor& monitor = bench.view.monitor;
    const auto shows = [&](const Order& order, auto&& happen) {
        bench.ask(milliseconds{0}, order);
        bench.run(0, 60);
        const bool before = bench.sender.progress(order.kind) == OrderProgress::kShown;
        happen();
        bench.run(61, 120);
        return !before && bench.sender.progress(order.kind) == OrderProgress::kShown;
    };
    EXPECT_TRUE(shows(order_of(OrderKind::kPause), [&] { monitor.paused = true; }));
    EXPECT_TRUE(shows(order_of(OrderKind::kResume), [&] { monitor.paused = false; }));
    EXPECT_TRUE(shows(order_of(OrderKind::kStart, 0, Modality::kVF), [&] {
        monitor.state = NodeState::kRunning;
        monitor.modality = Modality::kVF;
        ++bench.view.trial;
    }));
    EXPECT_FALSE(shows(order_of(OrderKind::kStart, 0, Modality::kCF), [&] { ++bench.view.trial; }));
    EXPECT_TRUE(shows(order_of(OrderKind::kStart, 0, Modality::kCF), [&] {
        monitor.trials = 5;  // the plan says which modality is next
        ++bench.view.trial;
    }));
    EXPECT_TRUE(shows(order_of(OrderKind::kEndTrial), [&] { monitor.state = NodeState::kIdle; }));
    EXPECT_TRUE(shows(order_of(OrderKind::kSeek, 12), [&] { monitor.time_s = 12.1; }));
    EXPECT_TRUE(shows(order_of(OrderKind::kQuit), [&] { bench.view.silent = true; }));
}

TEST(OrderSender, WhatNoMonitorShowsIsSaidFiveTimes) {
    OrderBench bench;
    bench.ask(milliseconds{0}, {.trial = 2, .kind = OrderKind::kExclude});
    bench.run(0, 2500);
    EXPECT_EQ(bench.heard().size(), 5U);
    EXPECT_EQ(bench.sender.progress(OrderKind::kExclude), OrderProgress::kSent);
    EXPECT_EQ(bench.sender.unanswered(), nullptr);
}

TEST(OrderSender, TheNewestDelayReplacesTheOneBefore) {
    OrderBench bench;
    bench.ask(milliseconds{0}, order_of(OrderKind::kDelay, 0.1));
    bench.ask(milliseconds{10}, order_of(OrderKind::kDelay, 0.2));
    bench.run(10, 70);
    const auto heard = bench.heard();
    ASSERT_EQ(heard.size(), 3U);
    EXPECT_EQ(heard[0].order.value, 0.1);
    EXPECT_EQ(heard[1].order.value, 0.2);
    EXPECT_EQ(heard[2].order.value, 0.2);
}

TEST(OrderSender, RepeatsKeepTheTrialForWhichTheyWereAsked) {
    OrderBench bench;
    bench.view.monitor.state = NodeState::kRunning;
    bench.ask(milliseconds{0}, order_of(OrderKind::kEndTrial));
    bench.run(0, 60);
    const auto all = bench.heard();
    ASSERT_EQ(all.size(), 2U);
    for (const HeardOrder& heard : all) EXPECT_EQ(heard.trial, 3U);
    bench.view.trial = 4;  // the next one runs already
    bench.run(61, 300);
    EXPECT_TRUE(bench.heard().empty());
    EXPECT_EQ(bench.sender.progress(OrderKind::kEndTrial), OrderProgress::kShown);
}

}  // namespace
}  // namespace thimble
