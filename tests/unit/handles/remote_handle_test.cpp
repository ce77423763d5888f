// A handle that another program drives, without that program: silence, nonsense, jumps, a second writer.
#include "master/devices/remote_handle.hpp"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace thimble {
namespace {

using testing::HasSubstr;

constexpr Duration kTick = std::chrono::milliseconds{1};
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class DrivenHandle final : public RemoteHandle {
  public:
    DrivenHandle() : RemoteHandle(10) {}

    // One tick in which these positions have come.
    HandleSample tick(const std::vector<double>& positions_m, std::uint64_t writer = 1) {
        now += kTick;
        coming_ = positions_m;
        writer_ = writer;
        return read(now);
    }
    void silence(Duration time) {
        for (Duration passed{}; passed < time; passed += kTick) tick({});
    }
    std::uint64_t counted(const char* what) const {
        nlohmann::ordered_json report;
        describe(report);
        return report.at("remote").at(what);
    }
    void begin() {
        start_trial(now, {});
        enable_force(now, true);
    }

    SessionTime now{std::chrono::seconds{1}};
    double told_N = 0;
    unsigned tellings = 0;

  private:
    void listen(SessionTime at) override {
        for (const double position_m : std::exchange(coming_, {})) take_position(at, writer_, position_m);
    }
    void tell_force(double force_hand_N) override {
        told_N = force_hand_N;
        ++tellings;
    }
    std::string driver() const override { return "the driver"; }

    std::vector<double> coming_;
    std::uint64_t writer_ = 1;
};

TEST(RemoteHandle, ReadsAndPushesWithinItsLimit) {
    DrivenHandle handle;
    handle.begin();
    EXPECT_FALSE(handle.tick({}).valid);
    EXPECT_TRUE(handle.tick({0.01}).valid);
    handle.command_force(handle.now, 50);
    EXPECT_EQ(handle.told_N, 10);
    EXPECT_EQ(handle.tick({0.0105, 0.011}).position_hand_m, 0.011);
    handle.command_force(handle.now, kNaN);
    EXPECT_EQ(handle.told_N, 0);
}

TEST(RemoteHandle, SilenceTakesForceAndSampleAndThenTheTrial) {
    DrivenHandle handle;
    handle.begin();
    handle.tick({0.01});
    handle.command_force(handle.now, 3);
    handle.silence(RemoteHandle::kStaleAfter);
    EXPECT_EQ(handle.told_N, 3);
    EXPECT_FALSE(handle.tick({}).valid);
    EXPECT_EQ(handle.told_N, 0);
    handle.command_force(handle.now, 3);
    EXPECT_EQ(handle.told_N, 0) << "no force for a hand that is not heard";
    EXPECT_TRUE(handle.tick({0.011}).valid);
    handle.silence(RemoteHandle::kLostAfter + kTick);
    EXPECT_THAT(handle.fault(), HasSubstr("the driver has sent no usable position"));
    EXPECT_FALSE(handle.tick({0.011}).valid) << "this trial has ended";
    handle.begin();
    EXPECT_EQ(handle.fault(), "");
    EXPECT_TRUE(handle.tick({0.5}).valid);
}

TEST(RemoteHandle, RefusesAndCountsWhatNoHandDoes) {
    DrivenHandle handle;
    handle.begin();
    handle.tick({0.01});
    EXPECT_EQ(handle.tick({kNaN, std::numeric_limits<double>::infinity(), 7}).position_hand_m, 0.01);
    EXPECT_EQ(handle.counted("not_numbers"), 3U);
    EXPECT_EQ(handle.tick({0.03, -0.01}).position_hand_m, 0.01);
    EXPECT_EQ(handle.counted("jumps"), 2U);
    EXPECT_EQ(handle.counted("positions"), 1U);
}

// Its device obeys the force too, and nothing counts the energy that it gets.
TEST(RemoteHandle, ASecondWriterEndsTheTrialAndNeverReplacesTheFirst) {
    DrivenHandle handle;
    handle.begin();
    handle.tick({0.01});
    handle.begin();
    EXPECT_FALSE(handle.tick({0.5}, 2).valid) << "first in this trial, but second to send";
    EXPECT_THAT(handle.fault(), HasSubstr("a second program sends positions beside the driver: stop one"));
    EXPECT_EQ(handle.counted("other_writers"), 1U);
    handle.command_force(handle.now, 3);
    EXPECT_EQ(handle.told_N, 0);
    handle.begin();
    EXPECT_TRUE(handle.tick({0.01}).valid);
    handle.silence(RemoteHandle::kLostAfter);
    handle.begin();
    EXPECT_TRUE(handle.tick({0.5}, 2).valid) << "a driver that was started anew";
    EXPECT_EQ(handle.fault(), "");
}

TEST(RemoteHandle, AllThatComesInOneTickHasTheSameAllowance) {
    DrivenHandle handle;
    handle.begin();
    handle.tick({0.0});
    handle.silence(4 * kTick);
    EXPECT_EQ(handle.tick({0.005, 0.01, 0.015, 0.02}).position_hand_m, 0.02);
    EXPECT_EQ(handle.tick({0.024, 0.027, 0.03}).position_hand_m, 0.024) << "three steps are no way around";
    EXPECT_EQ(handle.counted("jumps"), 2U);
}

// A hand that came back somewhere else must not pull the needle there at once.
TEST(RemoteHandle, AJumpAfterASilenceIsAJump) {
    DrivenHandle handle;
    handle.begin();
    handle.tick({0.0});
    handle.silence(std::chrono::milliseconds{200});
    EXPECT_FALSE(handle.tick({0.15}).valid);
    EXPECT_EQ(handle.counted("jumps"), 1U);
    EXPECT_EQ(handle.counted("stale"), 1U);
    EXPECT_TRUE(handle.tick({0.005}).valid);
}

TEST(RemoteHandle, AJumpThatLastsIsNeverTakenAndEndsTheTrial) {
    DrivenHandle handle;
    handle.begin();
    handle.tick({0.0});
    for (Duration passed{}; passed < RemoteHandle::kLostAfter + kTick; passed += kTick)
        EXPECT_EQ(handle.tick({0.05}).position_hand_m, 0);
    EXPECT_THAT(handle.fault(), HasSubstr("no usable position for 300 ms"));
    handle.now += kTick;
    EXPECT_FALSE(handle.take_stop(handle.now));
    handle.begin();
    EXPECT_EQ(handle.tick({0.05}).position_hand_m, 0.05);
}

TEST(RemoteHandle, SaysZeroBetweenTrialsAgainAndAgain) {
    DrivenHandle handle;
    handle.begin();
    handle.tick({0.01});
    handle.command_force(handle.now, 3);
    handle.enable_force(handle.now, false);
    EXPECT_EQ(handle.told_N, 0);
    const unsigned before = handle.tellings;
    for (int i = 0; i < 100; ++i) {
        handle.now += kTick;
        EXPECT_FALSE(handle.take_stop(handle.now));
    }
    EXPECT_EQ(handle.tellings - before, 10U);
    EXPECT_EQ(handle.told_N, 0);
}

}  // namespace
}  // namespace thimble
