// How often a handshake's messages are said, and for whom.
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/security/security_rig.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

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
