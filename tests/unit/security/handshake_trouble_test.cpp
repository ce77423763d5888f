// Ends that cannot agree, and the cause that each of them names.
#include <gtest/gtest.h>

#include "tests/unit/security/security_rig.hpp"

namespace thimble {
namespace {

TEST(HandshakeTrouble, AWrongLabKeyIsTwoSidesTroubleAndSilenceIsAnother) {
    PairRig rig;
    rig.wire.b.cut = true;
    rig.turn();
    EXPECT_EQ(rig.node->trouble(), PairTrouble::kSilent);
    EXPECT_EQ(rig.session->trouble(), PairTrouble::kSilent);
    rig.wire.b.cut = false;
    rig.restart_node(test_lab_key(8));
    rig.turn();
    EXPECT_FALSE(rig.node->established() || rig.session->established());
    EXPECT_EQ(rig.node->trouble(), PairTrouble::kWrongLabKey);
    EXPECT_EQ(rig.session->trouble(), PairTrouble::kWrongLabKey);
    EXPECT_GT(rig.session->counters().handshake_refused, 0U);
    rig.restart_node();
    rig.turn();
    EXPECT_EQ(rig.node->trouble(), PairTrouble::kNone);
    EXPECT_EQ(rig.session->trouble(), PairTrouble::kNone);
}

// An answer would be longer: an attacker could flood a third machine with it.
TEST(HandshakeTrouble, AHelloOfAnotherLengthGetsNoAnswer) {
    PairRig rig;
    rig.wire.b.cut = true;
    Datagram hello{'T', '1', static_cast<std::uint8_t>(PacketKind::kHello)};
    hello.resize(32);
    rig.wire.a.deliver(hello);
    rig.turn();
    EXPECT_EQ(rig.session->counters().handshake_refused, 1U);
    EXPECT_TRUE(rig.wire.a.said.empty());
}

// One key, two rigs, and a middle man who passes on all that they say.
TEST(HandshakeTrouble, ProgramsOfTwoRigsNeverAgree) {
    const auto of_rig = [](const char* rig) {
        return std::make_shared<const LabKey>(key_of_rig(*test_lab_key(), rig));
    };
    PairRig rig;
    rig.restart_session(of_rig("name B 27000"));
    rig.restart_node(of_rig("name A 27000"));
    for (int i = 0; i < 20; ++i) rig.turn(std::chrono::milliseconds{110});
    EXPECT_FALSE(rig.node->established() || rig.session->established());
    EXPECT_EQ(rig.node->counters().opened + rig.session->counters().opened, 0U);
    EXPECT_EQ(rig.node->trouble(), PairTrouble::kWrongLabKey);
    rig.restart_node(of_rig("name B 27000"));
    rig.turn();
    EXPECT_TRUE(rig.node->established());
}

TEST(HandshakeTrouble, WhoSpeaksWithoutProtectionIsNamed) {
    PairRig rig;
    rig.wire.b.cut = true;
    rig.wire.a.deliver(Datagram(100, 0));
    rig.turn();
    EXPECT_EQ(rig.session->trouble(), PairTrouble::kUnsealed);
    EXPECT_EQ(rig.node->trouble(), PairTrouble::kSilent);
}

// A network that was away overnight, and with it the keys' time: they agree anew, and old words stay old.
TEST(HandshakeTrouble, HoursOfSilenceEndWithTheNextWord) {
    PairRig rig;
    rig.turn();
    rig.wire.a.cut = rig.wire.b.cut = true;
    for (int i = 0; i < 9; ++i) rig.turn(std::chrono::hours{1});
    EXPECT_TRUE(rig.node->silent(rig.now));
    rig.wire.a.cut = rig.wire.b.cut = false;
    for (int i = 0; i < 10; ++i) rig.turn(std::chrono::milliseconds{110});
    rig.node->send(bytes_of("here"));
    rig.session->send(bytes_of("go"));
    EXPECT_EQ(received(*rig.session), "here");
    EXPECT_EQ(received(*rig.node), "go");
    EXPECT_EQ(rig.node->trouble(), PairTrouble::kNone);
}

}  // namespace
}  // namespace thimble
