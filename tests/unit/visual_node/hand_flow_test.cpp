#include "visual_node/hand_flow.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "common/queue_channel.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

struct StillHand final : HandSource {
    HandInput hand() const override { return input; }
    void home() override { input.position_hand_m = 0; }
    HandInput input;
};

// The datagrams of a channel, decoded by the master's flow.
struct Caught final : Channel {
    void send(Bytes datagram) override {
        if (const Message* message = flow.admit(time, datagram)) messages.push_back(*message);
    }
    Bytes take() override { return {}; }
    InboundFlow flow{Role::kVisual};
    SessionTime time{};
    std::vector<Message> messages;
};

struct HandFlowTest : testing::Test {
    void run_ms(int from, int to) {
        for (int ms = from; ms < to; ++ms) {
            if (move) hand.input.position_hand_m += 1e-4;
            caught.time = at(milliseconds{1000 + ms});
            flow.work(caught.time, true, 7);
        }
    }
    StillHand hand;
    Caught caught;
    HandFlow flow{5, &caught, &hand};
    bool move = false;
};

TEST_F(HandFlowTest, RestingHandGivesASignOfLife) {
    hand.input.engaged = true;
    flow.start_trial();
    run_ms(0, 100);
    EXPECT_EQ(caught.messages.size(), 10U);
    EXPECT_EQ(caught.messages.front().header.trial, 7U);
}

TEST_F(HandFlowTest, MovingHandIsSaidEveryMillisecond) {
    hand.input.engaged = true;
    flow.start_trial();
    move = true;
    run_ms(0, 100);
    ASSERT_EQ(caught.messages.size(), 100U);
    EXPECT_NEAR(std::get<HandInput>(caught.messages.back().body).position_hand_m, 100e-4, 1e-12);
}

TEST_F(HandFlowTest, LettingGoIsSaidAtOnce) {
    hand.input.engaged = true;
    flow.start_trial();
    run_ms(0, 3);
    hand.input.engaged = false;
    run_ms(3, 4);
    ASSERT_EQ(caught.messages.size(), 2U);
    EXPECT_FALSE(std::get<HandInput>(caught.messages.back().body).engaged);
}

TEST_F(HandFlowTest, ANewTrialHearsOfTheHandAtOnce) {
    flow.start_trial();
    run_ms(0, 2);
    ASSERT_EQ(caught.messages.size(), 1U);
    flow.start_trial();
    run_ms(2, 4);
    EXPECT_EQ(caught.messages.size(), 2U);
}

TEST_F(HandFlowTest, NothingBetweenTrials) {
    EXPECT_EQ(flow.next(), kNever);
    flow.start_trial();
    EXPECT_LE(flow.next(), at(milliseconds{0}));
    flow.work(at(milliseconds{5}), false, 7);
    EXPECT_EQ(flow.next(), kNever);
    EXPECT_TRUE(caught.messages.empty());
}

TEST_F(HandFlowTest, ATrialBeginsAtHome) {
    hand.input.position_hand_m = 0.05;
    flow.start_trial();
    EXPECT_EQ(hand.input.position_hand_m, 0);
}

TEST(HandFlowWithoutHand, IsSilentForEver) {
    HandFlow flow(1, nullptr, nullptr);
    flow.start_trial();
    flow.work(at(milliseconds{5}), true, 1);
    EXPECT_EQ(flow.next(), kNever);
}

}  // namespace
}  // namespace thimble
