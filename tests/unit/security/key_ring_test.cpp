// Keys of one-way flows: each node has those of its roles and directions, and new ones after every start.
#include <cstdint>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/security/security_rig.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

// A program with its control channel and some flows.
struct Program {
    Program(TestWire& control, Port local, Port remote, std::uint64_t seed, const SecurityTimes& times)
        : security(test_lab_key(), seeded_bytes(seed), times),
          channel(security.pair(control, local, remote)) {}
    void tick(SessionTime now) {
        security.tick(now);
        for (std::string word = received(*channel); !word.empty(); word = received(*channel)) heard += word;
        security.tick(now);
    }
    Security security;
    Channel* channel;
    std::string heard;
};

// The session, a master, a slave_sim, a visual, and the relay that the needle goes through.
class Rig {
  public:
    explicit Rig(const SecurityTimes& t = {}) : times(t) {
        start_session();
        start_master();
        start_slave();
        start_visual();
        start_relay();
    }

    void start_session() {
        server = std::make_unique<Security>(test_lab_key(), seeded_bytes(++lives), times);
        session[0] = server->pair(control[0].a, Port::kSessionMaster, Port::kMasterControl);
        session[1] = server->pair(control[1].a, Port::kSessionSlave, Port::kSlaveControl);
        session[2] = server->pair(control[2].a, Port::kSessionVisual, Port::kVisualControl);
        session[3] = server->pair(control[3].a, Port::kSessionNetem, Port::kNetemControl);
        record_in = server->inlet(record.b, Port::kSessionRecord);
    }
    void start_master() {
        master = std::make_unique<Program>(control[0].b, Port::kMasterControl, Port::kSessionMaster, ++lives,
                                           times);
        needle_out = master->security.outlet(needle.a, Port::kNetemNeedle);
    }
    void start_slave() {
        slave =
            std::make_unique<Program>(control[1].b, Port::kSlaveControl, Port::kSessionSlave, ++lives, times);
        needle_in = slave->security.inlet(passed.b, Port::kSlaveNeedle);
        record_out = slave->security.outlet(record.a, Port::kSessionRecord);
    }
    void start_visual() {
        visual = std::make_unique<Program>(control[2].b, Port::kVisualControl, Port::kSessionVisual, ++lives,
                                           times);
        false_needle = visual->security.outlet(needle.a, Port::kNetemNeedle);
        percept_out = visual->security.outlet(percept.a, Port::kMasterPerceptVisual);
    }

    void start_relay() {
        relay =
            std::make_unique<Program>(control[3].b, Port::kNetemControl, Port::kSessionNetem, ++lives, times);
        relay_in = relay->security.inlet(needle.b, Port::kNetemNeedle);
        relay_out = relay->security.outlet(passed.a, Port::kSlaveNeedle);
    }

    void turn(Duration later = {}) {
        now += later;
        for (int i = 0; i < 8; ++i) {
            server->tick(now);
            for (Channel* channel : session) received(*channel);
            server->tick(now);
            for (Program* node : {master.get(), slave.get(), visual.get(), relay.get()}) node->tick(now);
        }
    }
    // Of the session, so that no node begins anew.
    void show_life() {
        for (Channel* channel : session) channel->send(bytes_of("alive"));
    }
    std::string across(const char* word) {
        needle_out->send(bytes_of(word));
        return heard();
    }
    // The next word at the slave, after the relay has passed on all that it has.
    std::string heard() {
        for (std::string word = received(*relay_in); !word.empty(); word = received(*relay_in))
            relay_out->send(bytes_of(word));
        return received(*needle_in);
    }

    SecurityTimes times;
    SessionTime now{std::chrono::hours{5}};
    std::uint64_t lives = 0;
    std::array<TestPipe, 4> control;
    TestPipe needle, passed, record, percept;  // needle: to the relay; passed: from it
    std::unique_ptr<Security> server;
    std::array<Channel*, 4> session{};
    std::unique_ptr<Program> master, slave, visual, relay;
    Channel *record_in = nullptr, *needle_out = nullptr, *needle_in = nullptr, *record_out = nullptr,
            *false_needle = nullptr, *percept_out = nullptr, *relay_in = nullptr, *relay_out = nullptr;
};

TEST(FlowKeys, ComeWithTheHandshakes) {
    Rig rig;
    EXPECT_FALSE(rig.server->complete());
    EXPECT_EQ(rig.across("too early"), "");
    rig.turn();
    ASSERT_TRUE(rig.server->complete());
    EXPECT_EQ(rig.across("needle"), "needle");
    rig.record_out->send(bytes_of("sample"));
    EXPECT_EQ(received(*rig.record_in), "sample");
    EXPECT_GT(rig.passed.a.said.back().size(), std::string("needle").size());
}

TEST(FlowKeys, AVisualCannotCommandTheNeedle) {
    Rig rig;
    rig.turn();
    rig.false_needle->send(bytes_of("needle"));
    EXPECT_TRUE(rig.needle.a.said.empty());
    EXPECT_EQ(rig.visual->security.counters().not_sent, 1U);
    // A datagram of its own flow does not pass either, for any port in its header.
    rig.percept_out->send(bytes_of("percept"));
    Datagram percept = rig.percept.a.said.back();
    rig.passed.b.deliver(percept);
    percept[2] = static_cast<std::uint8_t>(PacketKind::kHop);
    percept[3] = static_cast<std::uint8_t>(Port::kSlaveNeedle);
    rig.passed.b.deliver(percept);
    EXPECT_EQ(rig.heard(), "");
    EXPECT_EQ(rig.slave->security.counters().wrong_role, 1U);
    EXPECT_EQ(rig.slave->security.counters().no_key, 1U);
}

TEST(FlowKeys, WhatTheRelayChangesOnTheWayIsForged) {
    Rig rig;
    rig.turn();
    rig.needle_out->send(bytes_of("needle"));
    std::string word = received(*rig.relay_in);
    EXPECT_EQ(word.find("needle"), std::string::npos) << "the relay cannot read it";
    word.back() ^= 1;
    rig.relay_out->send(bytes_of(word));
    EXPECT_EQ(rig.heard(), "");
    EXPECT_EQ(rig.slave->security.counters().forged, 1U);
}

// Delivered at once behind the relay it would be there before its delay: as it is, without its outer seal, or said to the relay twice.
TEST(FlowKeys, ADatagramFromBeforeTheRelayIsRefusedBehindIt) {
    Rig rig;
    rig.turn();
    rig.needle_out->send(bytes_of("needle"));
    const Datagram early = rig.needle.a.said.back();
    const Datagram within(early.begin() + kSealHeaderBytes, early.end() - kSealTagBytes);
    Datagram renamed = early;
    renamed[3] = static_cast<std::uint8_t>(Port::kSlaveNeedle);
    for (const Datagram& datagram : {early, within, renamed}) rig.passed.b.deliver(datagram);
    EXPECT_EQ(received(*rig.needle_in), "");
    EXPECT_EQ(rig.slave->security.counters().wrong_role, 2U);
    EXPECT_EQ(rig.slave->security.counters().no_key, 1U);
    EXPECT_EQ(rig.heard(), "needle") << "the relay has it, and passes it on";
    rig.needle.b.deliver(early);
    rig.needle.b.deliver(within);
    EXPECT_EQ(rig.heard(), "");
    EXPECT_EQ(rig.relay->security.counters().replayed, 1U);
    EXPECT_EQ(rig.relay->security.counters().wrong_role, 1U);
}

TEST(FlowKeys, ARestartedSlaveTakesNoRecordedCommand) {
    Rig rig;
    rig.turn();
    for (int i = 0; i < 5; ++i) EXPECT_EQ(rig.across("needle"), "needle");
    const auto recorded = rig.passed.a.said;
    rig.start_slave();
    const auto replay = [&] {
        for (const Datagram& datagram : recorded) rig.passed.b.deliver(datagram);
        return rig.heard();
    };
    EXPECT_EQ(replay(), "");
    rig.turn();
    EXPECT_EQ(replay(), "");
    EXPECT_EQ(rig.slave->security.counters().no_key, 2 * recorded.size());
    EXPECT_EQ(rig.across("fresh"), "fresh");
}

TEST(FlowKeys, ARestartedMasterNeverSealsUnderTheKeyItHadBefore) {
    Rig rig;
    rig.turn();
    EXPECT_EQ(rig.across("needle"), "needle");
    const auto first = read_seal_header(rig.passed.a.said.back());
    const auto recorded = rig.passed.a.said;
    rig.start_master();
    rig.turn();
    EXPECT_EQ(rig.across("fresh"), "fresh");
    EXPECT_NE(read_seal_header(rig.passed.a.said.back())->key_name, first->key_name);
    for (const Datagram& datagram : recorded) rig.passed.b.deliver(datagram);
    EXPECT_EQ(rig.heard(), "");
}

TEST(FlowKeys, ANewSessionIsObeyedAndNothingFromBefore) {
    Rig rig;
    rig.turn();
    EXPECT_EQ(rig.across("needle"), "needle");
    const auto commands = rig.passed.a.said;
    const auto orders = rig.control[1].a.said;
    rig.start_session();
    for (int i = 0; i < 5; ++i) rig.turn(milliseconds{100});
    ASSERT_TRUE(rig.server->complete());
    for (const Datagram& datagram : commands) rig.passed.b.deliver(datagram);
    for (const Datagram& datagram : orders) rig.control[1].b.deliver(datagram);
    EXPECT_EQ(rig.heard(), "");
    rig.turn();
    EXPECT_EQ(rig.slave->heard, "");
    EXPECT_EQ(rig.across("fresh"), "fresh");
}

// Renewal in the middle of a trial: nothing is lost, nothing is taken twice.
TEST(FlowKeys, AreRenewedWithoutLoss) {
    SecurityTimes times;
    times.renew_after = std::chrono::seconds{2};
    Rig rig(times);
    rig.turn();
    std::set<std::uint32_t> keys;
    std::vector<Datagram> recorded;
    for (int i = 0; i < 5000; ++i) {
        rig.now += milliseconds{1};
        rig.server->tick(rig.now);
        for (Channel* channel : rig.session) received(*channel);
        rig.server->tick(rig.now);
        if (i % 100 == 0) rig.show_life();
        for (Program* node : {rig.master.get(), rig.slave.get(), rig.visual.get(), rig.relay.get()})
            node->tick(rig.now);
        ASSERT_EQ(rig.across("needle"), "needle") << i;
        const Datagram& said = rig.passed.a.said.back();
        if (keys.insert(read_seal_header(said)->key_name).second) recorded.push_back(said);
    }
    EXPECT_GE(keys.size(), 3U);
    for (const Datagram& datagram : recorded) rig.passed.b.deliver(datagram);
    EXPECT_EQ(rig.heard(), "");
}

// A handshake within the grace of the epoch before, and a node whose receipt is late.
TEST(FlowKeys, ThoseInUseAreNotForgottenWhileTheNextAreAgreedOn) {
    Rig rig;
    rig.turn();
    for (int ms = 1; ms <= 2500; ++ms) {
        if (ms == 800) rig.start_visual();
        rig.control[1].b.cut = ms >= 800 && ms < 1060;
        if (ms % 100 == 99) {
            rig.show_life();
            for (Program* node : {rig.master.get(), rig.slave.get(), rig.visual.get(), rig.relay.get()})
                node->channel->send(bytes_of("alive"));
        }
        rig.turn(milliseconds{1});
        ASSERT_EQ(rig.across("needle"), "needle") << ms;
        rig.record_out->send(bytes_of("sample"));
        ASSERT_EQ(received(*rig.record_in), "sample") << ms;
    }
    EXPECT_TRUE(rig.server->complete());
}

TEST(FlowKeys, AreRenewedAfterSoManyDatagrams) {
    SecurityTimes times;
    times.renew_packets = 1000;
    Rig rig(times);
    rig.turn();
    for (int i = 0; i < 3500; ++i) {
        ASSERT_EQ(rig.across("needle"), "needle") << i;
        if (i % 20 == 0) rig.show_life();
        rig.turn(milliseconds{1});
    }
    EXPECT_LE(read_seal_header(rig.passed.a.said.back())->counter, 1010U);
    // Each node began once. The master began three times more; the relay, which sent as many, did as well.
    EXPECT_EQ(rig.server->counters().handshakes, 4U + 3U + 3U);
}

TEST(FlowKeys, RenewalGoesOnWhenANodeIsGone) {
    Rig rig;
    rig.turn();
    rig.control[2].b.cut = true;  // the visual is not heard any more
    rig.start_master();
    rig.turn();
    for (int i = 0; i < 10; ++i) rig.turn(milliseconds{50});
    EXPECT_EQ(rig.across("fresh"), "fresh");
}

// Its mail waited. Only a peer that stays silent afterwards may have been started anew.
TEST(FlowKeys, ANodeThatStoodStillKeepsItsKeys) {
    Rig rig;
    rig.turn();
    rig.show_life();
    rig.turn(std::chrono::seconds{1});
    EXPECT_EQ(rig.master->security.counters().handshakes, 1U);
    for (int i = 0; i < 3; ++i) rig.turn(milliseconds{100});
    EXPECT_EQ(rig.master->security.counters().handshakes, 1U);
    rig.turn(milliseconds{100});
    EXPECT_EQ(rig.master->security.counters().handshakes, 2U);
}

TEST(FlowKeys, WithoutItsKeysANodeIsNotHeard) {
    Rig rig;
    const auto beat = [&] {
        rig.master->channel->send(bytes_of("heartbeat"));
        return received(*rig.session[0]);
    };
    rig.master->tick(rig.now);
    received(*rig.session[0]);  // hello
    rig.master->tick(rig.now);
    received(*rig.session[0]);  // accept
    rig.master->tick(rig.now);
    EXPECT_EQ(beat(), "");
    rig.turn();
    EXPECT_EQ(beat(), "heartbeat");
}

}  // namespace
}  // namespace thimble
