// Orders: each request once, none for a trial that is over, and what each kind of session does with them.
#include <vector>

#include <gtest/gtest.h>

#include "common/queue_channel.hpp"
#include "session/participant/prompt.hpp"
#include "session/play/order_handlers.hpp"
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
        view.send(now, seen_trial, Order{.value = value, .trial = which, .kind = kind});
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

// An order in a participant session does what the typed line does.
class OrderLinesTest : public testing::Test {
  protected:
    std::optional<Refusal> say(OrderKind kind) { return lines.obey({}, {.kind = kind}); }
    PromptKind next() {
        const auto line = lines.take_line();
        EXPECT_TRUE(line);
        return line ? parse_prompt_line(*line).kind : PromptKind::kUnknown;
    }
    OrderLines lines;
};

TEST_F(OrderLinesTest, EachOrderIsTheLineThatSomebodyCouldType) {
    say(OrderKind::kRepeat);
    say(OrderKind::kExclude);
    say(OrderKind::kQuit);
    EXPECT_EQ(next(), PromptKind::kReject);
    EXPECT_EQ(next(), PromptKind::kExclude);
    EXPECT_EQ(next(), PromptKind::kQuit);
    EXPECT_FALSE(lines.take_line());
    EXPECT_FALSE(lines.ended());
}

TEST_F(OrderLinesTest, GoOnSaidManyTimesIsOneLine) {
    for (int i = 0; i < 7; ++i) say(OrderKind::kStart);
    EXPECT_EQ(next(), PromptKind::kGoOn);
    EXPECT_FALSE(lines.take_line());
}

TEST_F(OrderLinesTest, PauseTakesAGoOnBackAndResumeIsOne) {
    say(OrderKind::kStart);
    say(OrderKind::kPause);
    EXPECT_TRUE(lines.context().paused);
    EXPECT_FALSE(lines.take_line());
    say(OrderKind::kResume);
    EXPECT_FALSE(lines.context().paused);
    EXPECT_EQ(next(), PromptKind::kGoOn);
}

TEST_F(OrderLinesTest, ConditionsAreNotTheExperimentersToChange) {
    for (const OrderKind kind :
         {OrderKind::kDelay, OrderKind::kNetwork, OrderKind::kEndTrial, OrderKind::kSeek, OrderKind::kSpeed})
        EXPECT_EQ(say(kind), Refusal::kUnexpectedKind);
    EXPECT_FALSE(lines.take_line());
}

TEST(QuitHandler, KnowsQuitAlone) {
    QuitHandler handler;
    EXPECT_EQ(handler.obey({}, {.kind = OrderKind::kDelay}), Refusal::kUnexpectedKind);
    EXPECT_FALSE(handler.quit());
    EXPECT_EQ(handler.obey({}, {.kind = OrderKind::kQuit}), std::nullopt);
    EXPECT_TRUE(handler.quit());
}

// Which trial comes next in free play.
class PlayHandlerTest : public testing::Test {
  protected:
    std::optional<Refusal> say(OrderKind kind, Modality modality = Modality::kHF, double value = 0) {
        return handler.obey(now, {.value = value, .kind = kind, .modality = modality});
    }
    void end_trial(EndReason reason, Modality modality) {
        TrialRecord record;
        record.reason = reason;
        record.conditions.modality = modality;
        handler.trial_ended(now, record);
    }
    PlayHandler handler{Modality::kVF};
    SessionTime now = at(seconds{1});
};

TEST_F(PlayHandlerTest, TheFirstTrialBeginsByItselfOnce) {
    EXPECT_EQ(handler.take_due(now), Modality::kVF);
    EXPECT_FALSE(handler.take_due(now));
}

TEST_F(PlayHandlerTest, ACompletedTrialIsFollowedByAnotherAfterAPause) {
    handler.take_due(now);
    end_trial(EndReason::kCompleted, Modality::kCF);
    EXPECT_FALSE(handler.take_due(now + milliseconds{1900}));
    EXPECT_EQ(handler.take_due(now + seconds{2}), Modality::kCF);
}

TEST_F(PlayHandlerTest, AStartIsDueAtOnceAndReplacesWhatWouldCome) {
    handler.take_due(now);
    end_trial(EndReason::kCompleted, Modality::kVF);
    say(OrderKind::kStart, Modality::kHF);
    say(OrderKind::kStart, Modality::kHF);
    end_trial(EndReason::kInterrupted, Modality::kVF);  // it ended the running one
    EXPECT_EQ(handler.take_due(now), Modality::kHF);
    EXPECT_FALSE(handler.take_due(now + seconds{9}));
}

TEST_F(PlayHandlerTest, AfterAnEndNothingBeginsUntilAStart) {
    handler.take_due(now);
    say(OrderKind::kEndTrial);
    end_trial(EndReason::kInterrupted, Modality::kVF);
    EXPECT_FALSE(handler.take_due(now + seconds{60}));
    say(OrderKind::kStart, Modality::kCCF);
    EXPECT_EQ(handler.take_due(now), Modality::kCCF);
}

TEST_F(PlayHandlerTest, PauseAndQuitHoldBackTheNextTrial) {
    say(OrderKind::kPause);
    EXPECT_TRUE(handler.context().paused);
    EXPECT_FALSE(handler.take_due(now));
    say(OrderKind::kResume);
    EXPECT_EQ(handler.take_due(now), Modality::kVF);
    say(OrderKind::kPause);
    say(OrderKind::kStart, Modality::kHF);  // who says Start wants one
    EXPECT_EQ(handler.take_due(now), Modality::kHF);
    say(OrderKind::kStart, Modality::kHF);
    say(OrderKind::kQuit);
    EXPECT_TRUE(handler.quit());
    EXPECT_FALSE(handler.take_due(now));
}

TEST_F(PlayHandlerTest, RefusesWhatIsOfParticipantSessionsOrReplaysAndDelaysBeyondReason) {
    for (const OrderKind kind :
         {OrderKind::kRepeat, OrderKind::kExclude, OrderKind::kSeek, OrderKind::kSpeed})
        EXPECT_EQ(say(kind), Refusal::kUnexpectedKind);
    EXPECT_EQ(say(OrderKind::kDelay, Modality::kHF, 1.5), Refusal::kOutOfRange);
    EXPECT_EQ(say(OrderKind::kDelay, Modality::kHF, 0.5), std::nullopt);
}

}  // namespace
}  // namespace thimble
