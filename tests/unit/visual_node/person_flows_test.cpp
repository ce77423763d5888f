// The subject's key: said again until the page is turned, and for no other page.
#include "visual_node/person_flows.hpp"

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

TEST_F(HandFlowTest, SaysWhereAHandRestsWhereItMovesAndAtOnceThatItLetsGo) {
    flow.start_trial();
    run_ms(0, 100);
    EXPECT_EQ(caught.messages.size(), 10U) << "signs of life";
    EXPECT_EQ(caught.messages.front().header.trial, 7U);
    move = true;
    run_ms(100, 200);
    ASSERT_EQ(caught.messages.size(), 110U) << "every millisecond";
    EXPECT_NEAR(std::get<HandInput>(caught.messages.back().body).position_hand_m, 100e-4, 1e-12);
    move = false;
    hand.input.engaged = true;
    run_ms(200, 202);
    hand.input.engaged = false;
    run_ms(202, 203);
    ASSERT_EQ(caught.messages.size(), 112U);
    EXPECT_FALSE(std::get<HandInput>(caught.messages.back().body).engaged);
    flow.start_trial();
    run_ms(203, 204);
    ASSERT_EQ(caught.messages.size(), 113U);
    flow.start_trial();
    run_ms(204, 205);
    EXPECT_EQ(caught.messages.size(), 114U) << "a new trial hears at once of a hand that rests";
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
    HandFlow nobody(1, nullptr, nullptr);
    nobody.start_trial();
    nobody.work(at(milliseconds{5}), true, 1);
    EXPECT_EQ(nobody.next(), kNever);
}

Page page_of(std::uint32_t trial, PageKind kind = PageKind::kReady) { return {.trial = trial, .kind = kind}; }

// How often it is said from `from` to `to`, looked at each millisecond.
int said_between(GoOnRequest& request, int from_ms, int to_ms) {
    int said = 0;
    for (int ms = from_ms; ms < to_ms; ++ms) said += request.take_due(at(milliseconds{ms})) ? 1 : 0;
    return said;
}

TEST(GoOnRequest, IsRepeatedWhileItsPageStandsAndThenForgotten) {
    GoOnRequest request(true);
    request.turn(at(milliseconds{0}), page_of(1));
    EXPECT_EQ(said_between(request, 0, 100), 0);
    request.press(at(milliseconds{100}));
    request.turn(at(milliseconds{110}), page_of(1));  // said again by the session
    EXPECT_EQ(said_between(request, 100, 300), 4);
    request.turn(at(milliseconds{300}), page_of(2));
    EXPECT_EQ(said_between(request, 300, 600), 0);
    request.press(at(milliseconds{600}));
    EXPECT_EQ(said_between(request, 600, 5000), 40) << "for two seconds";
    request.press(at(milliseconds{5000}));
    EXPECT_EQ(said_between(request, 5000, 5010), 1) << "pressed again";
}

// An answer, unlike a key, is worth waiting for.
TEST(GoOnRequest, AnAnswerIsRepeatedUntilThePageIsTurned) {
    GoOnRequest request(false);  // who begins trials has nothing to do with it
    request.turn(at(milliseconds{0}), page_of(4, PageKind::kQuestion));
    request.press(at(milliseconds{1}));
    request.answer(at(milliseconds{1}), 3, 50);  // of the page before
    EXPECT_EQ(said_between(request, 1, 200), 0);
    request.answer(at(milliseconds{200}), 4, 75);
    request.answer(at(milliseconds{230}), 4, 80);
    EXPECT_GE(said_between(request, 230, 10'000), 190) << "without an end";
    EXPECT_EQ(request.order().kind, OrderKind::kAnswer);
    EXPECT_EQ(request.order().trial, 4U);
    EXPECT_EQ(request.order().value, 80);
    request.turn(at(milliseconds{10'000}), page_of(5, PageKind::kQuestion));
    EXPECT_EQ(said_between(request, 10'000, 10'200), 0);
}

TEST(GoOnRequest, IsNothingWhereNoPageWaitsOrTheProtocolForbidsIt) {
    GoOnRequest request(true);
    request.press(at(milliseconds{0}));  // in a trial
    request.turn(at(milliseconds{1}), page_of(1));
    EXPECT_EQ(said_between(request, 1, 200), 0);
    request.turn(at(milliseconds{200}), page_of(2, PageKind::kBreak));
    request.press(at(milliseconds{201}));
    EXPECT_EQ(request.next(), kNever);
    EXPECT_EQ(said_between(request, 201, 400), 0);

    GoOnRequest forbidden(false);
    forbidden.turn(at(milliseconds{0}), page_of(1));
    forbidden.press(at(milliseconds{1}));
    EXPECT_EQ(forbidden.next(), kNever);
    EXPECT_EQ(said_between(forbidden, 1, 200), 0);
}

}  // namespace
}  // namespace thimble
