// The stop button of a view, against six programs on stop buses.
#include "visual_node/views/stop_control.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "common/queue_channel.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

// A program's place to hear: answers go back to the view, as over a socket.
class Ear final : public Channel {
  public:
    explicit Ear(Channel& channel) : channel_(&channel) {}
    void send(Bytes datagram) override { channel_->send(datagram); }
    void answer(Bytes datagram) override {
        answered.assign(datagram.begin(), datagram.end());
        channel_->send(datagram);
    }
    std::vector<std::uint8_t> answered;  // the last one

  private:
    Bytes take() override { return channel_->receive(); }
    Channel* channel_;
};

class StopControlTest : public testing::Test {
  protected:
    StopControlTest() {
        StopOutlets among{}, at{};
        for (std::size_t i = 0; i < pipes_.size(); ++i) {
            among[i] = &pipes_[i].a;
            at[i] = &pipes_[i].a;
        }
        constexpr std::array kRoles{Role::kSession,   Role::kMaster, Role::kSlaveSim,
                                    Role::kCutaneous, Role::kVisual, Role::kNetem};
        buses_.reserve(kRoles.size());
        ears_.reserve(kRoles.size());
        for (std::size_t i = 0; i < kRoles.size(); ++i) {
            buses_.push_back(std::make_unique<StopBus>(kRoles[i], 100 + i));
            ears_.push_back(std::make_unique<Ear>(pipes_[i].b));
            buses_.back()->connect(*ears_.back(), among);
        }
        control = std::make_unique<StopControl>(7, at);
    }
    // Frames of 10 ms, with the button down or not. The last share of the way to a release.
    double pass(int ms, bool pressed) {
        double near = 0;
        for (int i = 0; i < ms; i += 10) {
            now += milliseconds{10};
            near = control->press(now, pressed, "a test");
            control->tick(now);
            for (auto& bus : buses_) bus->tick(now);
        }
        return near;
    }
    int stopped() const {
        int count = 0;
        for (const auto& bus : buses_) count += bus->stopped() ? 1 : 0;
        return count;
    }

    SessionTime now{};
    std::unique_ptr<StopControl> control;
    std::array<QueuePipe, 6> pipes_;
    std::vector<std::unique_ptr<Ear>> ears_;
    std::vector<std::unique_ptr<StopBus>> buses_;
};

TEST_F(StopControlTest, AClickStopsEveryProgramAndShowsThatAStopHolds) {
    pass(600, false);
    EXPECT_FALSE(control->holds());
    pass(20, true);
    EXPECT_EQ(stopped(), 6);
    pass(1200, false);
    EXPECT_TRUE(control->holds());
    EXPECT_EQ(buses_[2]->words(), "a test");
}

TEST_F(StopControlTest, APressThatStopsReleasesNothingHoweverLongItLasts) {
    pass(5000, true);
    EXPECT_EQ(stopped(), 6);
    EXPECT_TRUE(control->holds());
}

TEST_F(StopControlTest, OnlyAPressOfASecondReleases) {
    pass(20, true);
    pass(1500, false);
    EXPECT_NEAR(pass(510, true), 0.5, 0.02);
    EXPECT_EQ(stopped(), 6);
    EXPECT_EQ(pass(100, false), 0) << "and half a press is forgotten";
    pass(900, true);
    EXPECT_EQ(stopped(), 6);
    pass(300, true);
    EXPECT_EQ(stopped(), 0);
    pass(2000, false);
    EXPECT_FALSE(control->holds());
    EXPECT_EQ(stopped(), 0);
}

TEST_F(StopControlTest, AStopThatAnotherProgramHasPressedIsShownAndReleased) {
    pass(100, false);
    buses_[1]->stop(now, EndReason::kSafetyStop, "the guard");
    pass(1500, false);
    EXPECT_TRUE(control->holds());
    pass(1600, true);
    EXPECT_EQ(stopped(), 0);
    pass(1500, false);
    EXPECT_FALSE(control->holds());
}

// To a question, and to a stop: neither shows a stop that is over, nor makes the button release.
TEST_F(StopControlTest, ARecordedAnswerCountsForNothing) {
    for (const int ms : {20, 2000}) {
        pass(20, true);
        pass(ms, false);
        const std::vector<std::uint8_t> recorded = ears_[1]->answered;
        ASSERT_FALSE(recorded.empty());
        pass(2000, false);
        pass(2000, true);
        ASSERT_EQ(stopped(), 0);
        pass(2000, false);
        pipes_[1].b.send(recorded);
        pass(60, false);
        EXPECT_FALSE(control->holds()) << ms;
    }
}

TEST_F(StopControlTest, AStopWhileAReleaseIsUnderWayHolds) {
    pass(20, true);
    pass(1500, false);
    pass(1050, true);
    control->stop(now, "the stop key");
    pass(3000, false);
    EXPECT_EQ(stopped(), 6);
    EXPECT_TRUE(control->holds());
}

TEST_F(StopControlTest, AStopWhileTheButtonIsHeldToReleaseHolds) {
    pass(20, true);
    pass(1500, false);
    pass(500, true);
    control->stop(now, "the stop key");
    pass(600, true);
    pass(3000, false);
    EXPECT_EQ(stopped(), 6);
    EXPECT_TRUE(control->holds());
}

}  // namespace
}  // namespace thimble
