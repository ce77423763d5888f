// The stop bus: each program reaches all others, a stop holds until it is released on purpose, and what comes twice or late
// changes nothing.
#include "common/stop_bus.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "common/queue_channel.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

// Six programs, each with its own place to hear.
class Party {
  public:
    Party() {
        StopOutlets out{};
        for (std::size_t i = 0; i < pipes_.size(); ++i) out[i] = &pipes_[i].a;
        constexpr std::array kRoles{Role::kSession,   Role::kMaster, Role::kSlaveSim,
                                    Role::kCutaneous, Role::kVisual, Role::kNetem};
        for (std::size_t i = 0; i < pipes_.size(); ++i) {
            lines_.push_back(std::make_unique<StopBus>(kRoles[i], 100 + i));
            lines_.back()->connect(pipes_[i].b, out);
        }
    }
    StopBus& of(std::size_t i) { return *lines_[i]; }
    void tick(Duration time) {
        now = SessionTime{time};
        for (auto& line : lines_) line->tick(now);
    }
    int stopped() const {
        int count = 0;
        for (const auto& line : lines_) count += line->stopped() ? 1 : 0;
        return count;
    }
    void send(std::size_t to, const StopOrder& order, Role sender = Role::kExperimenter) {
        Encoder encoder;
        pipes_[to].a.send(encoder.encode(Header{9, now, 1, 0, sender}, order));
    }
    SessionTime now{};

  private:
    std::array<QueuePipe, 6> pipes_;
    std::vector<std::unique_ptr<StopBus>> lines_;
};

TEST(StopBus, OneStopStopsEverybodyInTheNextTick) {
    Party party;
    party.tick(milliseconds{1});
    EXPECT_EQ(party.stopped(), 0);
    party.of(3).stop(party.now, EndReason::kEmergencyStop, "a button");
    party.tick(milliseconds{2});
    EXPECT_EQ(party.stopped(), 6);
    EXPECT_EQ(party.of(1).words(), "a button");
    EXPECT_EQ(party.of(1).raised_by(), Role::kCutaneous);
    EXPECT_EQ(party.of(1).reason(), EndReason::kEmergencyStop);
}

TEST(StopBus, HoldsUntilReleasedAndIsNotTakenUpAgainByWhatComesLate) {
    Party party;
    party.of(1).stop(party.now, EndReason::kSafetyStop, "the guard");
    for (int ms = 1; ms < 1000; ++ms) party.tick(milliseconds{ms});
    EXPECT_EQ(party.stopped(), 6);
    party.of(0).release(party.now);
    party.tick(milliseconds{1001});
    EXPECT_EQ(party.stopped(), 0);
    // The first one's message while the release was on its way.
    for (int ms = 1002; ms < 3000; ++ms) {
        party.tick(milliseconds{ms});
        ASSERT_EQ(party.stopped(), 0);
    }
    // The next stop is another one, also while the release is still being said.
    party.of(0).release(party.now);
    party.of(2).stop(party.now, EndReason::kEmergencyStop, "again");
    party.tick(milliseconds{3001});
    party.tick(milliseconds{3100});
    EXPECT_EQ(party.stopped(), 6);
}

TEST(StopBus, NodesMayNotReleaseAndAReleaseIsOfTheStopThatItNames) {
    Party party;
    const StopOrder stop(7, StopKind::kStop, EndReason::kEmergencyStop, "a view");
    const StopOrder release(7, StopKind::kRelease, EndReason::kEmergencyStop, {});
    party.send(1, stop);
    party.tick(milliseconds{1});
    EXPECT_EQ(party.stopped(), 1) << "whoever was told";
    party.send(1, release, Role::kSlaveSim);
    party.tick(milliseconds{2});
    EXPECT_TRUE(party.of(1).stopped());
    EXPECT_EQ(party.of(1).counters().of(Refusal::kUnexpectedKind), 1U);
    party.send(1, StopOrder(9, StopKind::kRelease, EndReason::kEmergencyStop, {}));
    party.tick(milliseconds{300});
    EXPECT_TRUE(party.of(1).stopped()) << "another one's release";
    party.send(1, release);
    party.tick(milliseconds{301});
    EXPECT_EQ(party.stopped(), 0);
    party.send(1, stop);  // the same datagram, late
    party.tick(milliseconds{302});
    EXPECT_EQ(party.stopped(), 0);
}

TEST(StopBus, AStopWithoutANumberHoldsUntilReleasedToo) {
    Party party;
    party.send(2, StopOrder(0, StopKind::kStop, EndReason::kEmergencyStop, "no number"));
    for (int ms = 1; ms < 1000; ++ms) party.tick(milliseconds{ms});
    EXPECT_EQ(party.stopped(), 6);
    party.of(0).release(party.now);
    for (int ms = 1000; ms < 2000; ++ms) party.tick(milliseconds{ms});
    EXPECT_EQ(party.stopped(), 0);
}

// A second press at the same program, while a release of the first stop is on its way.
TEST(StopBus, WhoeverPressesAgainBeforeTheReleaseComesHasStoppedOnceMore) {
    Party party;
    party.of(3).stop(party.now, EndReason::kEmergencyStop, "a button");
    for (int ms = 1; ms < 1000; ++ms) party.tick(milliseconds{ms});
    party.of(3).stop(party.now, EndReason::kEmergencyStop, "a button");
    party.tick(milliseconds{1500});
    party.of(0).release(party.now);
    for (int ms = 1501; ms < 3000; ++ms) party.tick(milliseconds{ms});
    EXPECT_EQ(party.stopped(), 6);
    party.of(0).release(party.now);
    for (int ms = 3000; ms < 4000; ++ms) party.tick(milliseconds{ms});
    EXPECT_EQ(party.stopped(), 0) << "pressed twice, released twice";
    // A press long before is what was released; and a guard that still complains is no press.
    party.of(3).stop(party.now, EndReason::kSafetyStop, "the guard");
    party.of(3).stop(party.now, EndReason::kEmergencyStop, "a button");
    for (int ms = 4000; ms < 6000; ++ms) party.tick(milliseconds{ms});
    party.of(3).stop(party.now, EndReason::kSafetyStop, "the guard");
    party.of(0).release(party.now);
    for (int ms = 6000; ms < 7000; ++ms) party.tick(milliseconds{ms});
    EXPECT_EQ(party.stopped(), 0);
}

// A program that is started anew hears of the stop from the holders. A program that missed the release hears it from the session.
TEST(StopBus, WhatOneHoldsAllHoldAndLetGo) {
    Party party;
    party.send(3, StopOrder(7, StopKind::kStop, EndReason::kEmergencyStop, "a view"));
    for (int ms = 1; ms < 600; ++ms) party.tick(milliseconds{ms});
    EXPECT_EQ(party.stopped(), 6);
    party.send(0, StopOrder(7, StopKind::kRelease, EndReason::kEmergencyStop, {}));
    party.tick(milliseconds{600});
    EXPECT_EQ(party.stopped(), 5) << "one release, to the session alone";
    for (int ms = 601; ms < 1300; ++ms) party.tick(milliseconds{ms});
    EXPECT_EQ(party.stopped(), 0);
}

TEST(StopBus, WhatIsNoStopIsCounted) {
    Encoder encoder;
    StopBus line(Role::kMaster, 1);
    QueuePipe pipe;
    line.connect(pipe.b, {&pipe.a, &pipe.a, &pipe.a, &pipe.a, &pipe.a, &pipe.a});
    pipe.a.send(encoder.encode(Header{}, Heartbeat{}));
    const std::vector<std::uint8_t> noise(40, 7);
    pipe.a.send(noise);
    line.tick(SessionTime{});
    EXPECT_FALSE(line.stopped());
    EXPECT_EQ(line.counters().of(Refusal::kUnexpectedKind), 1U);
    EXPECT_EQ(line.counters().refused_total(), 2U);
}

// Two stops that merge begin anew at that instant: an earlier release does not release them.
TEST(StopBus, AMergedStopIsAsYoungAsTheMerge) {
    Party party;
    StopBus& session = party.of(0);
    const auto send = [&](std::uint64_t id, StopKind kind) {
        party.send(0, StopOrder(id, kind, EndReason::kEmergencyStop, "many"));
    };
    for (std::uint64_t id = 1; id <= 33; ++id) {
        party.tick(milliseconds{id <= 32 ? 1 : 500});
        send(id, StopKind::kStop);
        session.tick(party.now);
    }
    for (const std::uint64_t id : {31, 32, 33}) send(id, StopKind::kRelease);
    session.tick(party.now + milliseconds{100});
    session.release(party.now + milliseconds{100});
    EXPECT_TRUE(session.stopped()) << "31 and 32, which are one since 500 ms";
    session.release(party.now + milliseconds{199});
    EXPECT_TRUE(session.stopped());
    session.release(party.now + milliseconds{200});
    EXPECT_FALSE(session.stopped());
}

// A late stop is refused by the number of its release, and the oldest of 129 makes room.
TEST(StopBus, TheLast128ReleasesAreRemembered) {
    Party party;
    const auto send = [&](std::uint64_t id, StopKind kind) {
        party.send(1, StopOrder(id, kind, EndReason::kEmergencyStop, "late"));
        party.tick(party.now.time_since_epoch() + milliseconds{1});
    };
    for (std::uint64_t id = 1; id <= 128; ++id) send(id, StopKind::kRelease);
    for (const std::uint64_t id : {1, 128}) {
        send(id, StopKind::kStop);
        EXPECT_FALSE(party.of(1).stopped()) << id;
    }
    send(129, StopKind::kRelease);
    for (const std::uint64_t id : {2, 129}) {
        send(id, StopKind::kStop);
        EXPECT_FALSE(party.of(1).stopped()) << id;
    }
    send(1, StopKind::kStop);
    EXPECT_TRUE(party.of(1).stopped());
}

// More stops at once than the list holds: all act, and repeated releases end all of them.
TEST(StopBus, ManyStopsAtOnce) {
    Party party;
    for (std::uint64_t id = 1; id <= 40; ++id) {
        party.send(1, StopOrder(1000 + id, StopKind::kStop, EndReason::kEmergencyStop, "many"));
        party.tick(milliseconds{id});
    }
    EXPECT_TRUE(party.of(1).stopped());
    for (int ms = 41; ms < 2000; ++ms) party.tick(milliseconds{ms});
    EXPECT_EQ(party.stopped(), 6);
    party.of(0).release(party.now);
    for (int ms = 2000; ms < 4000; ++ms) party.tick(milliseconds{ms});
    party.of(0).release(party.now);
    for (int ms = 4000; ms < 6000; ++ms) party.tick(milliseconds{ms});
    EXPECT_EQ(party.stopped(), 0);
}

// The end where the line hears; it counts answers.
class AskedEnd final : public Channel {
  public:
    void send(Bytes /*datagram*/) override {}
    void answer(Bytes /*datagram*/) override { ++answers; }

    QueuePipe asked;
    int answers = 0;

  private:
    Bytes take() override { return asked.b.receive(); }
};

// The session's line; all others are one pipe.
class LoneLine {
  public:
    LoneLine() {
        StopOutlets out{};
        out.fill(&others_.a);
        line.connect(in, out);
    }
    void hear(const StopOrder& order) {
        Encoder encoder;
        in.asked.a.send(encoder.encode(Header{9, now, ++sequence_, 0, Role::kExperimenter}, order));
    }
    void tick(Duration time) {
        now = SessionTime{time};
        line.tick(now);
        for (; !others_.b.receive().empty(); ++said) {
        }
    }

    StopBus line{Role::kSession, 1};
    SessionTime now{};
    AskedEnd in;
    int said = 0;

  private:
    QueuePipe others_;
    std::uint32_t sequence_ = 0;
};

const StopOrder kPressed(5, StopKind::kStop, EndReason::kEmergencyStop, "a key");

TEST(StopPace, WhatIsHeldIsPassedOnTwiceASecondUntilItIsReleased) {
    LoneLine rig;
    rig.hear(kPressed);
    for (int ms = 0; ms <= 2000; ++ms) rig.tick(milliseconds{ms});
    EXPECT_EQ(rig.said, 4 * 6);  // to each of six, at 500, 1000, 1500 and 2000 ms
    rig.hear(StopOrder(5, StopKind::kRelease, EndReason::kEmergencyStop, {}));
    for (int ms = 2001; ms <= 3000; ++ms) rig.tick(milliseconds{ms});
    EXPECT_EQ(rig.said, 4 * 6);
    EXPECT_EQ(rig.line.next(), kNever);
}

TEST(StopPace, QuestionsAreAnsweredEveryTenMilliseconds) {
    LoneLine rig;
    rig.hear(kPressed);
    rig.tick({});
    rig.in.answers = 0;
    for (int ms = 10; ms < 60; ++ms) {
        rig.hear(StopOrder(0, StopKind::kAsk, EndReason::kEmergencyStop, {}));
        rig.tick(milliseconds{ms});
    }
    EXPECT_EQ(rig.in.answers, 5);
}

}  // namespace
}  // namespace thimble
