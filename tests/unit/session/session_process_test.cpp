// The session alone: the test is its five nodes, and says what they do.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/session/played_nodes.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// Every node that got the start order gets the end order.
TEST_F(SessionProcessTest, AnAbortBeforeTheFirstAcknowledgementEndsTheTrialWhereItWasBegun) {
    beat();
    start();
    session_.abort(EndReason::kInterrupted);
    session_.tick(now_ += milliseconds{1});
    EXPECT_FALSE(session_.finished()) << "nobody has said that it has stopped";
    run_for(seconds{1});
    EXPECT_TRUE(session_.finished());
    for (const Role role : {Role::kNetem, Role::kSlaveSim, Role::kCutaneous, Role::kVisual}) {
        EXPECT_EQ(node(role).count(ControlKind::kTrialStart), 1) << to_string(role);
        EXPECT_GE(node(role).count(ControlKind::kTrialEnd), 1) << to_string(role);
        EXPECT_EQ(node(role).state, NodeState::kIdle) << to_string(role);
    }
    EXPECT_EQ(record().reason, EndReason::kInterrupted);
}

// The master, which starts last, was told nothing, and so has nothing to acknowledge.
TEST_F(SessionProcessTest, WhoeverWasNotToldToBeginIsNotWaitedFor) {
    beat();
    start();
    session_.abort(EndReason::kInterrupted);
    const SessionTime asked = now_;
    run_for(seconds{10});
    EXPECT_TRUE(session_.finished());
    EXPECT_LT(now_ - asked, milliseconds{300});
    EXPECT_EQ(master_.count(ControlKind::kTrialStart), 0);
}

// Silence is not death: a program may have stalled.
TEST_F(SessionProcessTest, NodesThatAreSilentHearOfAnAbortAtLeastOnce) {
    reach_running();
    for (PlayedNode* one : nodes()) one->speaks = false;
    run_for(milliseconds{450});
    session_.abort(EndReason::kInterrupted);
    run_for(milliseconds{150});
    EXPECT_TRUE(session_.finished());
    for (const PlayedNode* one : nodes()) EXPECT_GE(one->count(ControlKind::kTrialEnd), 1);
}

TEST_F(SessionProcessTest, ATrialIsOverOnceEachNodeHasAcknowledgedItsEnd) {
    reach_running();
    cutaneous_.obeys = false;
    session_.abort(EndReason::kInterrupted);
    run_for(seconds{1});
    EXPECT_FALSE(session_.finished());
    cutaneous_.obeys = true;
    run_for(milliseconds{200});
    EXPECT_TRUE(session_.finished());
}

// Its control channel lives on, but it never acknowledges: that would take peer_wait.
TEST_F(SessionProcessTest, ALostPeerIsNotWaitedFor) {
    reach_running();
    records_ = slave_.obeys = false;
    const SessionTime silent = now_;
    run_for(seconds{10});
    ASSERT_TRUE(session_.finished());
    EXPECT_EQ(record().reason, EndReason::kPeerLost);
    EXPECT_EQ(record().lost_peer, Role::kSlaveSim);
    EXPECT_LT(now_ - silent, seconds{1});
    EXPECT_EQ(slave_.state, NodeState::kRunning);
}

TEST_F(SessionProcessTest, WhoeverIsNotTheLostOneIsWaitedFor) {
    reach_running();
    records_ = slave_.obeys = visual_.obeys = false;
    run_for(seconds{2});
    EXPECT_FALSE(session_.finished());
}

class MissedPeer : public SessionProcessTest {
  protected:
    // Whom the session blames when the master misses a peer after netem was silent for so long.
    Role blamed_after(Duration silence) {
        reach_running();
        netem_.speaks = false;
        run_for(silence);
        EXPECT_TRUE(session_.running()) << "it is not silent for long enough to be lost";
        stop_at(Role::kMaster, NodeState::kFailed, EndReason::kPeerLost);
        beat();
        EXPECT_EQ(record().reason, EndReason::kPeerLost);
        return record().lost_peer;
    }
};

TEST_F(MissedPeer, IsTheSilentOne) { EXPECT_EQ(blamed_after(milliseconds{300}), Role::kNetem); }
// As when two heartbeats were lost.
TEST_F(MissedPeer, IsTheAccuserIfNobodyIsSilent) {
    EXPECT_EQ(blamed_after(milliseconds{150}), Role::kMaster);
    EXPECT_TRUE(record().fault.starts_with("master gave the trial up, because it heard nothing"));
}

TEST_F(SessionProcessTest, WhoeverIsSilentForLongIsLost) {
    reach_running();
    visual_.speaks = false;
    run_for(milliseconds{450});
    EXPECT_TRUE(session_.running());
    run_for(milliseconds{200});
    EXPECT_EQ(record().reason, EndReason::kPeerLost);
    EXPECT_EQ(record().lost_peer, Role::kVisual);
}

// Its number must be known before a trial gets the next one. A clock reply, which may come first, does not say it.
TEST_F(SessionProcessTest, ANodeIsMissedUntilItsHeartbeatComes) {
    for (PlayedNode* one : nodes()) one->say(now_, ClockReply{});
    session_.tick(now_);
    EXPECT_NE(session_.missing_peers(now_, kPeerTimeout), "");
    beat();
    EXPECT_EQ(session_.missing_peers(now_, kPeerTimeout), "");
}

// Stopped, or kept from the processor of a busy machine, as the nodes may have been.
TEST_F(SessionProcessTest, WhoStoodStillListensBeforeItCallsANodeSilent) {
    reach_running();
    session_.tick(now_ += seconds{9});
    EXPECT_TRUE(session_.running());
    visual_.speaks = false;
    run_for(milliseconds{350});
    EXPECT_TRUE(session_.running());
    run_for(milliseconds{100});
    EXPECT_EQ(record().lost_peer, Role::kVisual);
}

TEST_F(SessionProcessTest, ANodeThatDoesNotBeginIsNamed) {
    visual_.obeys = false;
    start();
    run_for(seconds{20});
    EXPECT_EQ(record().reason, EndReason::kPeerLost);
    EXPECT_EQ(record().lost_peer, Role::kVisual);
    EXPECT_EQ(master_.count(ControlKind::kTrialStart), 0);
}

TEST_F(SessionProcessTest, ANodeThatIsSilentIsNamedBeforeOneThatDoesNotBegin) {
    netem_.obeys = false;
    visual_.speaks = false;
    start();
    run_for(seconds{20});
    EXPECT_EQ(record().lost_peer, Role::kVisual);
}

TEST_F(SessionProcessTest, TheMasterIsNotBlamedForWhatItWasNotToldYet) {
    visual_.trial = 1;  // it has given up at once
    stop_at(Role::kVisual, NodeState::kFailed, EndReason::kPeerLost);
    start();
    run_for(seconds{20});
    EXPECT_EQ(record().lost_peer, Role::kVisual);
}

TEST_F(SessionProcessTest, NumbersGoOnFromTheHighestThatANodeHasSeen) {
    slave_.trial = 4;
    visual_.trial = 12;
    master_.trial = 7;
    beat();
    EXPECT_EQ(session_.last_number(), 12U);
}

class PersonsSession : public SessionProcessTest {
  protected:
    PersonsSession() : SessionProcessTest(with_a_person()) {}
    static SessionSettings with_a_person() {
        SessionSettings settings = patient_settings();
        settings.ends_by_withdrawal = true;
        settings.subject_goes_on = true;
        return settings;
    }
    void beep() {
        contact_s_ = 1;
        beat();
        ASSERT_FALSE(std::isnan(record().beep_time_s));
        contact_s_ = 0;
    }
    // Whether the subject's request on such a page is heard; if not, it is counted.
    bool is_heard(PageKind kind, OrderKind order = OrderKind::kResume, std::uint32_t trial = 0) {
        Page page;
        page.kind = kind;
        session_.show(page);
        const auto refused = [this] { return session_.peer(Role::kVisual).counters().refused_total(); };
        const std::uint64_t before = refused();
        Order request;
        request.kind = order;
        visual_.trial = trial;
        visual_.say(now_ += milliseconds{1}, request);
        session_.tick(now_);
        const bool heard = session_.take_go_on();
        EXPECT_EQ(refused() - before, heard ? 0U : 1U);
        return heard;
    }
};

TEST_F(PersonsSession, AResumeIsHeardWhereAPageWaitsForItAndNoOtherOrderIs) {
    for (const PageKind waits : {PageKind::kWelcome, PageKind::kPractice, PageKind::kReady})
        EXPECT_TRUE(is_heard(waits));
    for (const PageKind rests : {PageKind::kBreak, PageKind::kPaused, PageKind::kDone, PageKind::kWait})
        EXPECT_FALSE(is_heard(rests));
    for (int kind = 0; kind <= static_cast<int>(OrderKind::kSpeed); ++kind) {
        const auto other = static_cast<OrderKind>(kind);
        EXPECT_EQ(is_heard(PageKind::kReady, other), other == OrderKind::kResume) << kind;
    }
    EXPECT_FALSE(is_heard(PageKind::kReady, OrderKind::kResume, 7)) << "asked for another trial";
}

TEST_F(PersonsSession, AnAnswerIsHeardOnItsOwnQuestionOnly) {
    Page page;
    page.kind = PageKind::kQuestion;
    page.trial = 3;
    Order answer;
    answer.kind = OrderKind::kAnswer;
    answer.value = 75;
    const auto heard = [&](std::uint32_t question) {
        session_.show(page);
        answer.trial = question;
        visual_.say(now_ += milliseconds{1}, answer);
        session_.tick(now_);
        return session_.take_answer();
    };
    EXPECT_EQ(heard(3), 75);
    EXPECT_FALSE(heard(2));
    page.kind = PageKind::kReady;
    EXPECT_FALSE(heard(3)) << "no question is shown";
    EXPECT_FALSE(session_.take_go_on());
}

// An instant in touch with the tissue, and the time begins anew.
TEST_F(PersonsSession, ATrialEndsOnceTheNeedleWasFreeWithoutAPause) {
    reach_running();
    phase_ = TissuePhase::kFree;
    run_for(seconds{1});
    ASSERT_TRUE(session_.running()) << "before the beep";
    phase_ = TissuePhase::kContact;
    beep();
    for (int i = 0; i < 3; ++i) {
        phase_ = TissuePhase::kFree;
        run_for(milliseconds{250});
        phase_ = TissuePhase::kContact;
        beat();
        ASSERT_TRUE(session_.running()) << i;
    }
    phase_ = TissuePhase::kFree;
    run_for(kWithdrawnFor + 2 * kBeat);
    EXPECT_EQ(record().reason, EndReason::kCompleted);
}

TEST_F(PersonsSession, TheNextTrialDoesNotEndByTheWithdrawalOfTheLastOne) {
    reach_running();
    beep();
    phase_ = TissuePhase::kFree;
    run_for(seconds{2});
    ASSERT_TRUE(session_.finished());
    reach_running();
    phase_ = TissuePhase::kContact;
    beep();
    phase_ = TissuePhase::kFree;
    run_for(milliseconds{250});
    EXPECT_TRUE(session_.running());
}

// A request from before a page's trial was known here: a node that has seen a higher number counts.
TEST_F(PersonsSession, AWishIsForThePageOfTheHighestNumberSeen) {
    visual_.trial = master_.trial = 12;
    beat();
    Page page;
    page.kind = PageKind::kReady;
    session_.show(page);
    Order request;
    request.kind = OrderKind::kResume;
    visual_.trial = 11;
    visual_.say(now_, request);
    visual_.trial = 12;
    session_.tick(now_);
    EXPECT_FALSE(session_.take_go_on());
    visual_.say(now_, request);
    session_.tick(now_);
    EXPECT_TRUE(session_.take_go_on());
    visual_.trial = 0;  // of a program that was started again
    visual_.say(now_, request);
    session_.tick(now_);
    EXPECT_TRUE(session_.take_go_on());
    visual_.say(now_, request);
    session_.tick(now_);
    page.trial = 4;
    session_.show(page);
    EXPECT_FALSE(session_.take_go_on()) << "it was about the page before";
}

class QuickSession : public SessionProcessTest {
  protected:
    QuickSession() : SessionProcessTest(quick_settings()) {}
    static SessionSettings quick_settings() {
        return session_settings(read_system_settings(ConfigFile::parse(
            "[master]\nsample_period_s = 0.0001\n[trial]\ntimeout_s = 60\n", "session.toml")));
    }
};

// The samples of a whole trial: none is moved in the tick of another one.
TEST_F(QuickSession, TheRecordHasRoomForEachSampleOfTheMaster) {
    start();
    EXPECT_GE(record().samples.capacity(), 600'000U);
}

TEST_F(QuickSession, ATrialThatNobodyEndsTimesOut) {
    reach_running();
    run_for(seconds{59});
    EXPECT_TRUE(session_.running());
    run_for(seconds{3});
    EXPECT_TRUE(session_.finished());
    EXPECT_EQ(record().reason, EndReason::kTimeout);
}

// As when bits are flipped in the number of a command that comes twice, and in the stamp of another.
TEST(TrialRecorder, KeepsOneAnswerToACommandAndGoesOnAfterAWrongTime) {
    TrialRecorder recorder(SessionSettings{});
    recorder.begin({});
    ForceFeedback answer;
    for (const int at_ms : {1, 2, 2, 900, 3, 4}) {
        answer.echo_time = SessionTime{std::chrono::milliseconds{at_ms}};
        recorder.add({}, answer);
    }
    std::vector<double> times_s;
    for (const TrajectorySample& sample : recorder.record().samples) times_s.push_back(sample.time_s);
    EXPECT_THAT(times_s, testing::ElementsAre(0, 0.001, 0.899, 0.002, 0.003));
}

}  // namespace
}  // namespace thimble
