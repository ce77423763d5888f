// Which trial comes next in free play.
#include "session/play/play_handler.hpp"

#include <gtest/gtest.h>

#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class PlayHandlerTest : public testing::Test {
  protected:
    std::optional<Refusal> say(OrderKind kind, Modality modality = Modality::kHF, double value = 0) {
        Order order;
        order.kind = kind;
        order.modality = modality;
        order.value = value;
        return handler.obey(now, order);
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

TEST_F(PlayHandlerTest, PauseHoldsBackTheNextTrial) {
    say(OrderKind::kPause);
    EXPECT_TRUE(handler.context().paused);
    EXPECT_FALSE(handler.take_due(now));
    say(OrderKind::kResume);
    EXPECT_EQ(handler.take_due(now), Modality::kVF);
    say(OrderKind::kPause);
    say(OrderKind::kStart, Modality::kHF);  // who says Start wants one
    EXPECT_EQ(handler.take_due(now), Modality::kHF);
}

TEST_F(PlayHandlerTest, QuitEndsEverything) {
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
