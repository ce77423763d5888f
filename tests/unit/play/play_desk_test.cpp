// Which trial comes next in free play.
#include "session/play/play_desk.hpp"

#include <gtest/gtest.h>

#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class PlayDeskTest : public testing::Test {
  protected:
    std::optional<Refusal> say(OrderKind kind, Modality modality = Modality::kHF, double value = 0) {
        Order order;
        order.kind = kind;
        order.modality = modality;
        order.value = value;
        return desk.obey(now, order);
    }
    void end_trial(EndReason reason, Modality modality) {
        TrialRecord record;
        record.reason = reason;
        record.conditions.modality = modality;
        desk.trial_ended(now, record);
    }
    PlayDesk desk{Modality::kVF};
    SessionTime now = at(seconds{1});
};

TEST_F(PlayDeskTest, TheFirstTrialBeginsByItselfOnce) {
    EXPECT_EQ(desk.take_due(now), Modality::kVF);
    EXPECT_FALSE(desk.take_due(now));
}

TEST_F(PlayDeskTest, ACompletedTrialIsFollowedByAnotherAfterAPause) {
    desk.take_due(now);
    end_trial(EndReason::kCompleted, Modality::kCF);
    EXPECT_FALSE(desk.take_due(now + milliseconds{1900}));
    EXPECT_EQ(desk.take_due(now + seconds{2}), Modality::kCF);
}

TEST_F(PlayDeskTest, AStartIsDueAtOnceAndReplacesWhatWouldCome) {
    desk.take_due(now);
    end_trial(EndReason::kCompleted, Modality::kVF);
    say(OrderKind::kStart, Modality::kHF);
    say(OrderKind::kStart, Modality::kHF);
    end_trial(EndReason::kInterrupted, Modality::kVF);  // it ended the running one
    EXPECT_EQ(desk.take_due(now), Modality::kHF);
    EXPECT_FALSE(desk.take_due(now + seconds{9}));
}

TEST_F(PlayDeskTest, AfterAnEndNothingBeginsUntilAStart) {
    desk.take_due(now);
    say(OrderKind::kEndTrial);
    end_trial(EndReason::kInterrupted, Modality::kVF);
    EXPECT_FALSE(desk.take_due(now + seconds{60}));
    say(OrderKind::kStart, Modality::kCCF);
    EXPECT_EQ(desk.take_due(now), Modality::kCCF);
}

TEST_F(PlayDeskTest, PauseHoldsBackTheNextTrial) {
    say(OrderKind::kPause);
    EXPECT_TRUE(desk.context().paused);
    EXPECT_FALSE(desk.take_due(now));
    say(OrderKind::kResume);
    EXPECT_EQ(desk.take_due(now), Modality::kVF);
    say(OrderKind::kPause);
    say(OrderKind::kStart, Modality::kHF);  // who says Start wants one
    EXPECT_EQ(desk.take_due(now), Modality::kHF);
}

TEST_F(PlayDeskTest, QuitEndsEverything) {
    say(OrderKind::kQuit);
    EXPECT_TRUE(desk.quit());
    EXPECT_FALSE(desk.take_due(now));
}

TEST_F(PlayDeskTest, RefusesWhatIsOfSittingsOrReplaysAndDelaysBeyondReason) {
    for (const OrderKind kind :
         {OrderKind::kRepeat, OrderKind::kExclude, OrderKind::kSeek, OrderKind::kSpeed})
        EXPECT_EQ(say(kind), Refusal::kUnexpectedKind);
    EXPECT_EQ(say(OrderKind::kDelay, Modality::kHF, 1.5), Refusal::kOutOfRange);
    EXPECT_EQ(say(OrderKind::kDelay, Modality::kHF, 0.5), std::nullopt);
}

}  // namespace
}  // namespace thimble
