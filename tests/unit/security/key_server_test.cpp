// Grants of keys and their receipts, and the two programs that exchange them.
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/security/security_rig.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

TEST(KeyMessages, HoldWhatWasWritten) {
    KeyGrant grant;
    grant.session = 0x0123456789abcdef;
    grant.epoch = 77;
    grant.in_use = true;
    grant.count = kMostFlowKeys;
    for (std::size_t i = 0; i < kMostFlowKeys; ++i) {
        grant.keys[i].keyed = {static_cast<Port>(i), i % 2 == 1};
        grant.keys[i].key.bytes.fill(static_cast<std::uint8_t>(i + 1));
    }
    KeyText text{};
    const Bytes bytes = write_grant(grant, text);
    const auto read = read_grant(bytes);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->session, grant.session);
    EXPECT_EQ(read->epoch, 77U);
    EXPECT_TRUE(read->in_use);
    ASSERT_EQ(read->count, kMostFlowKeys);
    EXPECT_EQ(read->keys[7].keyed, (KeyedFlow{static_cast<Port>(7), true}));
    EXPECT_EQ(read->keys[7].key.bytes, grant.keys[7].key.bytes);
    for (std::size_t size = 0; size < bytes.size(); ++size)
        EXPECT_FALSE(read_grant(bytes.first(size))) << size;
    const auto receipt = read_receipt(write_receipt({5, true}, text));
    ASSERT_TRUE(receipt);
    EXPECT_EQ(receipt->epoch, 5U);
    EXPECT_FALSE(read_grant(write_receipt({5, true}, text)));
}

// A server with nodes that hear grants and confirm none.
struct DeafNodes {
    explicit DeafNodes(std::size_t count) : rigs(count), heard(count) {
        for (std::size_t i = 0; i < count; ++i) {
            server.serve(*rigs[i].session);
            rigs[i].node->set_keys_hook([this, i](Bytes text) {
                if (const auto grant = read_grant(text)) heard[i].push_back(*grant);
            });
        }
    }
    // Nodes from `first` on are not there yet.
    void turn(std::size_t first) {
        now += milliseconds{1};
        for (std::size_t i = 0; i < first; ++i) {
            rigs[i].now = now;
            rigs[i].node->send(bytes_of("alive"));
            rigs[i].session->send(bytes_of("alive"));
            rigs[i].turn();
        }
        server.tick(now);
        for (std::size_t i = 0; i < first; ++i) rigs[i].turn();
    }

    SessionTime now{std::chrono::hours{5}};
    FlowEnds ends;
    KeyServer server{ends, seeded_bytes(1), SecurityTimes{}};
    std::vector<PairRig> rigs;
    std::vector<std::vector<KeyGrant>> heard;
};

TEST(KeyServer, RepeatsItselfTwentyTimesASecond) {
    DeafNodes nodes(1);
    for (int ms = 0; ms < 1000; ++ms) nodes.turn(1);
    EXPECT_NEAR(static_cast<double>(nodes.heard[0].size()), 20, 2);
}

TEST(KeyServer, UsesItsKeysThoughANodeDoesNotConfirmThem) {
    DeafNodes nodes(1);
    for (int ms = 0; ms < 200; ++ms) nodes.turn(1);
    EXPECT_FALSE(nodes.heard[0].back().in_use);
    for (int ms = 200; ms < 400; ++ms) nodes.turn(1);
    EXPECT_TRUE(nodes.heard[0].back().in_use);
}

// Recorded datagrams of an epoch that has begun would be new to it.
TEST(KeyServer, ANodeThatComesWithinAnEpochGetsTheNextOnesKeys) {
    DeafNodes nodes(2);
    for (int ms = 0; ms < 100; ++ms) nodes.turn(1);
    ASSERT_EQ(nodes.heard[0].back().epoch, 1U);
    for (int ms = 100; ms < 600; ++ms) nodes.turn(2);
    ASSERT_FALSE(nodes.heard[1].empty());
    EXPECT_EQ(nodes.heard[1].front().epoch, 2U);
}

TEST(KeyRing, TakesNoEpochFromBefore) {
    PairRig rig;
    FlowEnds ends;
    KeyRing ring(ends, *rig.node, SecurityTimes{});
    std::vector<std::uint32_t> receipts;
    rig.session->set_keys_hook([&receipts](Bytes text) {
        if (const auto receipt = read_receipt(text)) receipts.push_back(receipt->epoch);
    });
    rig.turn();
    KeyText text{};
    for (const std::uint32_t epoch : {2U, 1U, 3U}) {
        KeyGrant grant;
        grant.session = 7;
        grant.epoch = epoch;
        rig.session->send_keys(write_grant(grant, text));
        rig.turn();
    }
    EXPECT_EQ(receipts, (std::vector<std::uint32_t>{2, 3}));
}

}  // namespace
}  // namespace thimble
