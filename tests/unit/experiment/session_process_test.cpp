// The session alone: the test is its five nodes, and says what they do.
#include "experiment/session_process.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "common/queue_channel.hpp"
#include "experiment/system_settings.hpp"

namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Duration kBeat = milliseconds{50};

std::size_t place(Role role) {
    return static_cast<std::size_t>(std::find(kNodeRoles.begin(), kNodeRoles.end(), role) -
                                    kNodeRoles.begin());
}

// A node obeys each order at once, unless the test has it do something else.
class PlayedNode {
  public:
    explicit PlayedNode(Role role) : role_(role), flow_(role, 7, {&pipe.b}) {}

    void tick(SessionTime now) {
        while (const Message* message = orders_.receive(now, pipe.b)) {
            const auto* order = std::get_if<SessionControl>(&message->body);
            if (order == nullptr) continue;
            heard.push_back(order->kind);
            if (obeys) obey(message->header.trial, *order);
        }
        if (!speaks) return;
        Heartbeat heartbeat;
        heartbeat.state = state;
        heartbeat.reason = reason;
        flow_.send(now, trial, heartbeat);
    }
    void say(SessionTime now, const Order& order) { flow_.send(now, trial, order); }
    long count(ControlKind kind) const { return std::count(heard.begin(), heard.end(), kind); }

    QueuePipe pipe;  // a: the session's end
    bool obeys = true, speaks = true;
    NodeState state = NodeState::kIdle;
    EndReason reason = EndReason::kNone;
    std::uint32_t trial = 0;
    std::vector<ControlKind> heard;

  private:
    void obey(std::uint32_t number, const SessionControl& order) {
        if (order.kind == ControlKind::kTrialStart && number != trial) {
            trial = number;
            state = NodeState::kRunning;
        }
        if (order.kind == ControlKind::kTrialEnd && number == trial) state = NodeState::kIdle;
    }

    Role role_;
    OutboundFlow flow_;
    InboundFlow orders_{Role::kSession};
};

SessionSettings patient_settings() {
    SessionSettings settings;
    settings.contact_hold = seconds{1};
    settings.trial_timeout = seconds{600};
    return settings;
}

class SessionProcessTest : public testing::Test {
  protected:
    explicit SessionProcessTest(const SessionSettings& settings = patient_settings())
        : session(1, settings,
                  {{&netem.pipe.a, &slave.pipe.a, &cutaneous.pipe.a, &visual.pipe.a, &master.pipe.a},
                   &record_.a}) {}

    std::array<PlayedNode*, 5> nodes() { return {&netem, &slave, &cutaneous, &visual, &master}; }
    PlayedNode& node(Role role) { return *nodes().at(place(role)); }

    // Nodes speak every 50 ms, and slave_sim answers, until so much time has passed or the trial is over.
    void run_for(Duration time) {
        const SessionTime end = now + time;
        while (now < end && !session.finished()) beat();
    }
    void beat() {
        now += kBeat;
        if (records) answer();
        for (PlayedNode* one : nodes()) one->tick(now);
        session.tick(now);
    }
    void answer() {
        ForceFeedback feedback;
        feedback.echo_time = now;
        feedback.phase = phase;
        feedback.contact_time_s = contact_s;
        slave_record_.send(now, session.number(), feedback);
    }
    void start(std::uint32_t number = 1) {
        session.start(TrialConditions{}, number);
        session.tick(now);
    }
    void reach_running() {
        start(session.number() + 1);
        run_for(milliseconds{500});
        ASSERT_TRUE(session.running());
    }
    void stop_at(Role role, NodeState state, EndReason reason) {
        node(role).obeys = false;
        node(role).state = state;
        node(role).reason = reason;
    }
    const TrialRecord& record() const { return session.record(); }

    PlayedNode netem{Role::kNetem}, slave{Role::kSlaveSim}, cutaneous{Role::kCutaneous},
        visual{Role::kVisual}, master{Role::kMaster};
    SessionTime now{seconds{100}};
    TissuePhase phase = TissuePhase::kContact;
    double contact_s = 0;
    bool records = true;

  private:
    QueuePipe record_;
    OutboundFlow slave_record_{Role::kSlaveSim, 9, {&record_.b}};

  protected:
    SessionProcess session;
};

// Nobody who was told to begin is left running.
TEST_F(SessionProcessTest, AnAbortBeforeTheFirstAcknowledgementEndsTheTrialWhereItWasBegun) {
    beat();
    start();
    session.abort(EndReason::kInterrupted);
    session.tick(now += milliseconds{1});
    EXPECT_FALSE(session.finished()) << "nobody has said that it has stopped";
    run_for(seconds{1});
    EXPECT_TRUE(session.finished());
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
    session.abort(EndReason::kInterrupted);
    const SessionTime asked = now;
    run_for(seconds{10});
    EXPECT_TRUE(session.finished());
    EXPECT_LT(now - asked, milliseconds{300});
    EXPECT_EQ(master.count(ControlKind::kTrialStart), 0);
}

// Silence is not death: a program may have stalled.
TEST_F(SessionProcessTest, NodesThatAreSilentHearOfAnAbortAtLeastOnce) {
    reach_running();
    for (PlayedNode* one : nodes()) one->speaks = false;
    now += milliseconds{600};
    session.abort(EndReason::kInterrupted);
    session.tick(now);
    EXPECT_TRUE(session.finished());
    for (PlayedNode* one : nodes()) {
        one->tick(now);
        EXPECT_EQ(one->count(ControlKind::kTrialEnd), 1);
    }
}

TEST_F(SessionProcessTest, ATrialIsOverOnceEachNodeHasAcknowledgedItsEnd) {
    reach_running();
    cutaneous.obeys = false;
    session.abort(EndReason::kInterrupted);
    run_for(seconds{1});
    EXPECT_FALSE(session.finished());
    cutaneous.obeys = true;
    run_for(milliseconds{200});
    EXPECT_TRUE(session.finished());
}

// Its control channel lives on, but it never acknowledges: that would take peer_wait.
TEST_F(SessionProcessTest, ALostPeerIsNotWaitedFor) {
    reach_running();
    slave.obeys = false;
    records = false;
    const SessionTime silent = now;
    run_for(seconds{10});
    ASSERT_TRUE(session.finished());
    EXPECT_EQ(record().reason, EndReason::kPeerLost);
    EXPECT_EQ(record().lost_peer, Role::kSlaveSim);
    EXPECT_LT(now - silent, seconds{1});
    EXPECT_EQ(slave.state, NodeState::kRunning);
}

// The others have to acknowledge all the same.
TEST_F(SessionProcessTest, WhoeverIsNotTheLostOneIsWaitedFor) {
    reach_running();
    slave.obeys = visual.obeys = false;
    records = false;
    run_for(seconds{2});
    EXPECT_FALSE(session.finished());
}

TEST_F(SessionProcessTest, ANodeThatMissesAPeerIsRightIfAnotherIsSilent) {
    reach_running();
    netem.speaks = false;
    run_for(milliseconds{300});
    ASSERT_TRUE(session.running()) << "it is not silent for long enough to be lost";
    stop_at(Role::kMaster, NodeState::kFailed, EndReason::kPeerLost);
    beat();
    EXPECT_EQ(record().reason, EndReason::kPeerLost);
    EXPECT_EQ(record().lost_peer, Role::kNetem);
}

TEST_F(SessionProcessTest, ANodeThatMissesAPeerIsBlamedItselfIfNobodyIsSilent) {
    reach_running();
    netem.speaks = false;
    run_for(milliseconds{150});  // as when two heartbeats were lost
    stop_at(Role::kMaster, NodeState::kFailed, EndReason::kPeerLost);
    beat();
    EXPECT_EQ(record().reason, EndReason::kPeerLost);
    EXPECT_EQ(record().lost_peer, Role::kMaster);
}

TEST_F(SessionProcessTest, WhoeverIsSilentForLongIsLost) {
    reach_running();
    visual.speaks = false;
    run_for(milliseconds{450});
    EXPECT_TRUE(session.running());
    run_for(milliseconds{200});
    EXPECT_EQ(record().reason, EndReason::kPeerLost);
    EXPECT_EQ(record().lost_peer, Role::kVisual);
}

TEST_F(SessionProcessTest, ANodeThatDoesNotBeginIsNamed) {
    visual.obeys = false;
    start();
    run_for(seconds{20});
    EXPECT_EQ(record().reason, EndReason::kPeerLost);
    EXPECT_EQ(record().lost_peer, Role::kVisual);
    EXPECT_EQ(master.count(ControlKind::kTrialStart), 0);
}

TEST_F(SessionProcessTest, ANodeThatIsSilentIsNamedBeforeOneThatDoesNotBegin) {
    netem.obeys = false;
    visual.speaks = false;
    start();
    run_for(seconds{20});
    EXPECT_EQ(record().lost_peer, Role::kVisual);
}

TEST_F(SessionProcessTest, TheMasterIsNotBlamedForWhatItWasNotToldYet) {
    visual.trial = 1;  // it has given up at once
    stop_at(Role::kVisual, NodeState::kFailed, EndReason::kPeerLost);
    start();
    run_for(seconds{20});
    EXPECT_EQ(record().lost_peer, Role::kVisual);
}

TEST_F(SessionProcessTest, NumbersGoOnFromTheHighestThatANodeHasSeen) {
    slave.trial = 4;
    visual.trial = 12;
    master.trial = 7;
    beat();
    EXPECT_EQ(session.last_number(), 12U);
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
        contact_s = 1;
        beat();
        ASSERT_FALSE(std::isnan(record().beep_time_s));
        contact_s = 0;
    }
};

// An instant in touch with the tissue, and the time begins anew.
TEST_F(PersonsSession, ATrialEndsOnceTheNeedleWasFreeWithoutAPause) {
    reach_running();
    phase = TissuePhase::kFree;
    run_for(seconds{1});
    ASSERT_TRUE(session.running()) << "before the beep";
    phase = TissuePhase::kContact;
    beep();
    for (int i = 0; i < 3; ++i) {
        phase = TissuePhase::kFree;
        run_for(milliseconds{250});
        phase = TissuePhase::kContact;
        beat();
        ASSERT_TRUE(session.running()) << i;
    }
    phase = TissuePhase::kFree;
    run_for(kWithdrawnFor + 2 * kBeat);
    EXPECT_EQ(record().reason, EndReason::kCompleted);
}

TEST_F(PersonsSession, TheNextTrialDoesNotEndByTheWithdrawalOfTheLastOne) {
    reach_running();
    beep();
    phase = TissuePhase::kFree;
    run_for(seconds{2});
    ASSERT_TRUE(session.finished());
    reach_running();
    phase = TissuePhase::kContact;
    beep();
    phase = TissuePhase::kFree;
    run_for(milliseconds{250});
    EXPECT_TRUE(session.running());
}

// A wish from before a page's trial was known here: a node that has seen a higher number counts.
TEST_F(PersonsSession, AWishIsForThePageOfTheHighestNumberSeen) {
    visual.trial = master.trial = 12;
    beat();
    Page page;
    page.kind = PageKind::kReady;
    session.show(page);
    Order wish;
    wish.kind = OrderKind::kResume;
    visual.trial = 11;
    visual.say(now, wish);
    visual.trial = 12;
    session.tick(now);
    EXPECT_FALSE(session.take_go_on());
    visual.say(now, wish);
    session.tick(now);
    EXPECT_TRUE(session.take_go_on());
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

}  // namespace
}  // namespace thimble
