// Two that share a lab key, and those who do not, or come from the past.
#include <algorithm>
#include <deque>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/security/security_rig.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

constexpr Duration kMoment = milliseconds{110};  // after which a lost message is said again

// Computed with another library: X25519 of Python's cryptography, BLAKE2b of its hashlib.
TEST(HandshakeMessages, AreWhatThePageSays) {
    const auto lab = test_lab_key(7);
    OneTimeKey a, b;
    a.secret.bytes.fill(1);
    b.secret.bytes.fill(2);
    a.open =
        make_one_time_key([](auto bytes) { std::fill(bytes.begin(), bytes.end(), std::uint8_t{1}); }).open;
    b.open =
        make_one_time_key([](auto bytes) { std::fill(bytes.begin(), bytes.end(), std::uint8_t{2}); }).open;
    EXPECT_EQ(hex(write_handshake(*lab, {PacketKind::kHello, Port::kSessionMaster, a.open, {}})),
              "54310300000000000000000000000000a4e09292b651c278b9772c569f5fa9bb13d906b46ab68c9df9dc2b4409f8a2"
              "09000000"
              "00000000000000000000000000000000000000000000000000000000007b88d2fe271caceefae6f8614e4730a10000"
              "00000000"
              "00000000000000000000");
    const HandshakeParties said{Port::kMasterControl, Port::kSessionMaster, a.open, b.open};
    const auto ours = agree(*lab, said, a.secret, b.open), theirs = agree(*lab, said, b.secret, a.open);
    ASSERT_TRUE(ours && theirs);
    EXPECT_EQ(hex(ours->initiator_to_responder.bytes),
              "4e7e08ff6de9e60b66287eb245e974019bfad704ffc5dbcbf3fd6546de8d6324");
    EXPECT_EQ(hex(theirs->responder_to_initiator.bytes),
              "77d2d1334788c43c55deaa481ecfe0a5b5ba8be36f2814aa1596525d5199084e");
    SecretKey secret;
    secret.bytes.fill(9);
    EXPECT_EQ(hex(flow_key(secret, {Port::kSlaveNeedle}).bytes),
              "5b560cf6f4e310d86c530bcf7ad188450ab830c619e3e534733a1a16d19dcec5");
}

TEST(HandshakeMessages, KeysDependOnEverythingSaid) {
    const auto lab = test_lab_key();
    const OneTimeKey a = make_one_time_key(seeded_bytes(1)), b = make_one_time_key(seeded_bytes(2));
    const HandshakeParties said{Port::kMasterControl, Port::kSessionMaster, a.open, b.open};
    const auto key = [&](const LabKey& with, const HandshakeParties& parties) {
        return hex(agree(with, parties, a.secret, b.open)->initiator_to_responder.bytes);
    };
    HandshakeParties other_role = said, other_words = said;
    other_role.initiator = Port::kVisualControl;
    other_words.initiator_key[0] ^= 1;
    EXPECT_NE(key(*lab, said), key(*lab, other_role));
    EXPECT_NE(key(*lab, said), key(*lab, other_words));
    EXPECT_NE(key(*lab, said), key(*test_lab_key(8), said));
    EXPECT_FALSE(
        agree(*lab, said, a.secret, PublicKey{}));  // a key that gives the same secret with each peer
}

TEST(Handshake, BothSpeakAfterOneExchangeAndNothingIsSentBefore) {
    PairRig rig;
    const auto speak = [&rig] {
        rig.node->send(bytes_of("here"));
        rig.session->send(bytes_of("go"));
    };
    speak();
    EXPECT_TRUE(rig.wire.a.said.empty() && rig.wire.b.said.empty());
    EXPECT_EQ(rig.node->counters().not_sent, 1U);
    rig.turn();
    ASSERT_TRUE(rig.node->established() && rig.session->established());
    speak();
    EXPECT_EQ(received(*rig.session), "here");
    EXPECT_EQ(received(*rig.node), "go");
    EXPECT_EQ(rig.node->counters().handshakes, 1U);
    EXPECT_EQ(rig.wire.a.said.size(), 3U);  // an offer, the first word, "go"
    EXPECT_EQ(rig.node->trouble(), PairTrouble::kNone);
}

// Whichever of the first messages of either side are lost.
TEST(Handshake, LostMessagesAreSaidAgain) {
    for (unsigned lost = 0; lost < 64; ++lost) {
        PairRig rig;
        for (unsigned step = 0; step < 40; ++step) {
            rig.now += milliseconds{20};
            rig.wire.b.cut = step < 30 && (lost >> (step / 5) & 1U) != 0;
            rig.wire.a.cut = step < 30 && (lost >> (5 - step / 5) & 1U) != 0;
            for (SecurePair* end : {rig.node.get(), rig.session.get()}) {
                end->tick(rig.now);
                EXPECT_EQ(received(*end), "");
            }
        }
        rig.node->send(bytes_of("here"));
        rig.session->send(bytes_of("go"));
        EXPECT_EQ(received(*rig.session), "here") << lost;
        EXPECT_EQ(received(*rig.node), "go") << lost;
    }
}

// Longer under way than any message waits to be repeated.
TEST(Handshake, WorksOverASlowNetwork) {
    constexpr Duration kUnderWay = milliseconds{700};
    PairRig rig;
    rig.wire.a.cut = rig.wire.b.cut = true;
    std::deque<std::pair<SessionTime, Datagram>> to_session, to_node;
    std::size_t session_said = 0, node_said = 0;
    for (int i = 0; i < 300; ++i) {
        rig.now += milliseconds{10};
        for (; node_said < rig.wire.b.said.size(); ++node_said)
            to_session.emplace_back(rig.now + kUnderWay, rig.wire.b.said[node_said]);
        for (; session_said < rig.wire.a.said.size(); ++session_said)
            to_node.emplace_back(rig.now + kUnderWay, rig.wire.a.said[session_said]);
        for (; !to_session.empty() && to_session.front().first <= rig.now; to_session.pop_front())
            rig.wire.a.deliver(to_session.front().second);
        for (; !to_node.empty() && to_node.front().first <= rig.now; to_node.pop_front())
            rig.wire.b.deliver(to_node.front().second);
        if (rig.session->established()) rig.session->send(bytes_of("alive"));
        for (SecurePair* end : {rig.node.get(), rig.session.get()}) {
            end->tick(rig.now);
            for (int k = 0; k < 20; ++k) received(*end);
        }
    }
    EXPECT_TRUE(rig.node->established());
    EXPECT_EQ(rig.node->trouble(), PairTrouble::kNone);
    EXPECT_EQ(rig.node->generation(), 1U);
}

TEST(Handshake, AChangedBitInAnyMessageKeepsTheDoorShut) {
    for (std::size_t bit = 0; bit < 8 * kHandshakeBytes; ++bit) {
        for (const int flipped : {0, 1, 2}) {  // hello, offer, accept
            PairRig rig;
            rig.node->tick(rig.now);
            const auto pass = [&](TestWire& from, TestWire& to, bool flip) {
                Datagram datagram = from.said.back();
                if (flip) datagram[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
                to.deliver(datagram);
            };
            rig.wire.a.cut = rig.wire.b.cut = true;
            while (!rig.wire.a.receive().empty()) {
            }
            pass(rig.wire.b, rig.wire.a, flipped == 0);
            EXPECT_EQ(received(*rig.session), "");
            if (rig.wire.a.said.empty()) continue;  // the hello was refused
            pass(rig.wire.a, rig.wire.b, flipped == 1);
            EXPECT_EQ(received(*rig.node), "");
            pass(rig.wire.b, rig.wire.a, flipped == 2);
            EXPECT_EQ(received(*rig.session), "");
            EXPECT_FALSE(rig.session->established()) << bit << ' ' << flipped;
        }
    }
}

// All earlier messages of one side are replayed to a new process at the other side.
TEST(Handshake, WhatWasSaidBeforeIsNotTakenByANewProcess) {
    for (const bool node_is_new : {true, false}) {
        SCOPED_TRACE(node_is_new);
        PairRig rig;
        rig.turn();
        rig.session->send(bytes_of("go"));
        rig.node->send(bytes_of("here"));
        const auto recorded = node_is_new ? rig.wire.a.said : rig.wire.b.said;
        if (node_is_new) rig.restart_node();
        if (!node_is_new) rig.restart_session();
        rig.wire.a.cut = rig.wire.b.cut = true;
        SecurePair& fresh = node_is_new ? *rig.node : *rig.session;
        for (int i = 0; i < 5; ++i) {
            fresh.tick(rig.now += kMoment);
            for (const Datagram& datagram : recorded)
                (node_is_new ? rig.wire.b : rig.wire.a).deliver(datagram);
            EXPECT_EQ(received(fresh), "");
        }
        EXPECT_FALSE(fresh.established());
        EXPECT_EQ(fresh.generation(), 0U);
        EXPECT_EQ(fresh.counters().opened, 0U);
        EXPECT_GT(fresh.counters().no_key, 0U);
        EXPECT_GT(fresh.counters().handshake_refused, 0U);
    }
}

TEST(Handshake, AReplayWithinTheSessionIsCountedAndChangesNothing) {
    PairRig rig;
    rig.turn();
    rig.node->send(bytes_of("here"));
    EXPECT_EQ(received(*rig.session), "here");
    const auto recorded = rig.wire.b.said;
    rig.wire.a.cut = true;
    for (const Datagram& datagram : recorded) rig.wire.a.deliver(datagram);
    EXPECT_EQ(received(*rig.session), "");
    EXPECT_EQ(rig.session->counters().replayed, 1U);
    EXPECT_EQ(rig.session->generation(), 1U);
    rig.node->send(bytes_of("still here"));
    EXPECT_EQ(received(*rig.session), "still here");
}

TEST(Handshake, NobodyTakesItsOwnWordsForThePeers) {
    PairRig rig;
    rig.turn();
    rig.node->send(bytes_of("here"));
    EXPECT_EQ(received(*rig.session), "here");
    for (const Datagram& datagram : std::vector(rig.wire.b.said)) rig.wire.b.deliver(datagram);
    for (const Datagram& datagram : std::vector(rig.wire.a.said)) rig.wire.a.deliver(datagram);
    EXPECT_EQ(received(*rig.node), "");
    EXPECT_EQ(received(*rig.session), "");
    EXPECT_EQ(rig.node->counters().wrong_role, 1U);
    EXPECT_EQ(rig.node->generation() + rig.session->generation(), 2U);
}

TEST(Handshake, EachRestartIsANewHandshake) {
    PairRig rig;
    rig.turn();
    rig.restart_node();
    rig.turn();
    EXPECT_EQ(rig.session->generation(), 2U);
    rig.node->send(bytes_of("again"));
    EXPECT_EQ(received(*rig.session), "again");
    rig.restart_session();
    rig.turn(milliseconds{400});  // the node notices the silence
    EXPECT_EQ(rig.node->generation(), 2U);
    rig.session->send(bytes_of("anew"));
    EXPECT_EQ(received(*rig.node), "anew");
}

// A recording of an earlier node's handshake must not bring its session back, nor its counters.
TEST(Handshake, AnEarlierNodesHandshakeDoesNotReplaceTheLivingOnes) {
    PairRig rig;
    rig.turn();
    const auto recorded = rig.wire.b.said;
    rig.restart_node();
    rig.turn();
    for (const Datagram& datagram : recorded) rig.wire.a.deliver(datagram);
    rig.turn();
    EXPECT_EQ(rig.session->generation(), 2U);
    rig.node->send(bytes_of("mine"));
    EXPECT_EQ(received(*rig.session), "mine");
}

TEST(Handshake, KeysAreRenewedByAgeAndByCountAndTheOldOnesLastForAWhile) {
    SecurityTimes times;
    times.renew_after = std::chrono::seconds{10};
    times.renew_packets = 50;
    PairRig rig(times);
    rig.turn();
    const auto talk = [&] {
        rig.session->send(bytes_of("go"));
        rig.turn(milliseconds{100});
    };
    for (int i = 0; i < 110; ++i) talk();
    EXPECT_EQ(rig.node->generation(), 2U);  // by age
    rig.wire.b.cut = true;
    rig.node->send(bytes_of("late"));
    const Datagram late = rig.wire.b.said.back();
    rig.wire.b.cut = false;
    for (int i = 0; i < 60; ++i) rig.node->send(bytes_of("x"));
    rig.turn();
    EXPECT_EQ(rig.node->generation(), 3U);  // by count
    rig.wire.a.deliver(late);
    EXPECT_EQ(received(*rig.session), "late");
    rig.wire.b.cut = true;
    rig.turn(milliseconds{1100});
    rig.wire.a.deliver(late);
    EXPECT_EQ(received(*rig.session), "");
    EXPECT_GT(rig.session->counters().no_key, 0U);
}

// Held back until after a new handshake, it would bring back keys that are recorded.
TEST(Handshake, AWordAboutKeysCountsUnderTheNewestKeysAlone) {
    PairRig rig;
    rig.turn();
    int heard = 0;
    rig.node->set_keys_hook([&](Bytes) { ++heard; });
    rig.session->send_keys(bytes_of("keys"));
    rig.turn();
    EXPECT_EQ(heard, 1);
    rig.wire.a.cut = true;
    rig.session->send_keys(bytes_of("keys held back"));
    const Datagram held_back = rig.wire.a.said.back();
    rig.wire.a.cut = false;
    rig.node->renew();
    rig.turn();
    ASSERT_EQ(rig.node->generation(), 2U);
    const int before = heard;
    rig.wire.b.deliver(held_back);
    rig.turn();
    EXPECT_EQ(heard, before);
}

// However many hellos, recorded or new, come in between: nothing is remembered of them.
TEST(Handshake, AFloodOfHellosDoesNotKeepTheNodeOut) {
    PairRig old;
    old.turn();
    PairRig rig;
    rig.restart_session();  // random numbers of its own
    rig.restart_node();
    rig.wire.a.cut = rig.wire.b.cut = true;
    rig.node->tick(rig.now);
    const auto flood = [&] {
        for (int i = 0; i < 200; ++i) {
            for (const Datagram& datagram : old.wire.b.said) rig.wire.a.deliver(datagram);
            rig.wire.a.deliver(Datagram(kHandshakeBytes, static_cast<std::uint8_t>(i)));
        }
        for (int i = 0; i < 20; ++i) EXPECT_EQ(received(*rig.session), "");
    };
    flood();
    rig.wire.a.deliver(rig.wire.b.said.back());
    EXPECT_EQ(received(*rig.session), "");
    rig.wire.b.deliver(rig.wire.a.said.back());
    EXPECT_EQ(received(*rig.node), "");
    flood();
    rig.wire.a.deliver(rig.wire.b.said.back());
    EXPECT_EQ(received(*rig.session), "");
    EXPECT_TRUE(rig.session->established());
    EXPECT_EQ(rig.session->generation(), 1U);
}

TEST(Handshake, AFloodIsWorkedOffInPortions) {
    PairRig rig;
    rig.turn();
    for (int i = 0; i < 1000; ++i) rig.wire.a.deliver(Datagram(100, 0));
    rig.node->send(bytes_of("here"));
    EXPECT_EQ(received(*rig.session), "");  // there is more, but the tick goes on
    std::string heard;
    for (int i = 0; i < 20 && heard.empty(); ++i) heard = received(*rig.session);
    EXPECT_EQ(heard, "here");
    EXPECT_EQ(rig.session->counters().unsealed, 1000U);
}

TEST(HandshakeLimits, AMessageIsForOnePort) {
    const auto lab = test_lab_key();
    const OneTimeKey key = make_one_time_key(seeded_bytes(1));
    const HandshakeBytes hello =
        write_handshake(*lab, {PacketKind::kHello, Port::kSessionMaster, key.open, {}});
    EXPECT_TRUE(read_handshake(*lab, Port::kSessionMaster, hello));
    EXPECT_FALSE(read_handshake(*lab, Port::kSessionVisual, hello));
}

// The offer may be of a session that is gone.
TEST(HandshakeLimits, AfterThreeAcceptsInVainANodeSaysHelloAgain) {
    PairRig rig;
    rig.node->tick(rig.now);
    received(*rig.session);  // it offers
    rig.wire.b.cut = true;
    received(*rig.node);
    for (int i = 0; i < 3; ++i) {
        rig.now += milliseconds{110};  // after which a lost message is said again
        rig.node->tick(rig.now);
    }
    std::vector<PacketKind> said;
    for (const Datagram& datagram : rig.wire.b.said) said.push_back(static_cast<PacketKind>(datagram[2]));
    EXPECT_EQ(said, (std::vector{PacketKind::kHello, PacketKind::kAccept, PacketKind::kAccept,
                                 PacketKind::kAccept, PacketKind::kHello}));
}

TEST(HandshakeLimits, AFloodUnderAnotherLabKeyIsAnsweredFourTimesASecond) {
    PairRig rig;
    rig.restart_node(test_lab_key(8));
    rig.node->tick(rig.now);
    const Datagram foreign = rig.wire.b.said.back();
    for (int i = 0; i < 100; ++i) {
        rig.now += milliseconds{10};
        rig.wire.a.deliver(foreign);
        rig.session->tick(rig.now);
        received(*rig.session);
    }
    EXPECT_EQ(rig.wire.a.said.size(), 4U);
}

}  // namespace
}  // namespace thimble
