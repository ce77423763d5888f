// A handle and the thread that talks to its device, in virtual time and without that thread.
#include "master/devices/mailbox_handle.hpp"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/refusal.hpp"

namespace thimble {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr Duration kExchangeTick = std::chrono::milliseconds{1};

TEST(PackedVector, KeepsValuesAndTag) {
    const double none = std::numeric_limits<double>::quiet_NaN();
    const auto word = PackedVector::pack({0.123456, -0.5, none}, 1e-6, 9);
    EXPECT_EQ(PackedVector::tag(word), 9U);
    EXPECT_THAT(PackedVector::values(word, 1e-6),
                ElementsAre(DoubleNear(0.123456, 1e-9), DoubleNear(-0.5, 1e-9), 0));
    EXPECT_THAT(PackedVector::values(PackedVector::pack({1e9, -1e9, 0}, 1e-4, 0), 1e-4),
                ElementsAre(DoubleNear(52.4287, 1e-9), DoubleNear(-52.4287, 1e-9), 0));
}

class Exchanged : public testing::Test {
  protected:
    void SetUp() override { handle().enable_force(now, true); }
    MailboxHandle& handle() {
        if (!made_) made_ = std::make_unique<MailboxHandle>(axis, limit_N, 2U, "Device D1", box);
        return *made_;
    }
    // One tick of both sides, the device first.
    HandleSample tick(double force_hand_N, double z_m = 0) {
        now += kExchangeTick;
        carried_N = box.carry(now, withhold);
        box.publish({0, y_m, z_m}, buttons);
        return rest(force_hand_N);
    }
    HandleSample rest(double force_hand_N) {
        const HandleSample sample = handle().read(now);
        handle().command_force(now, force_hand_N);
        return sample;
    }

    DeviceMailbox box;
    AxisSettings axis{2, -1};
    SessionTime now{std::chrono::seconds{1}};
    DeviceVector carried_N{};
    double y_m = 0, limit_N = 3;
    std::uint32_t buttons = 0;
    bool withhold = false;

  private:
    std::unique_ptr<MailboxHandle> made_;
};

TEST_F(Exchanged, PositionsComeAndForcesGo) {
    tick(2);
    tick(2);
    EXPECT_NEAR(tick(50, -0.001).position_hand_m, 0.001, 1e-9);
    tick(0);
    EXPECT_THAT(carried_N, ElementsAre(0, 0, DoubleNear(3, 1e-9)));
}

TEST_F(Exchanged, AForceThatIsNotRenewedEnds) {
    for (int i = 0; i < 3; ++i) tick(2);
    EXPECT_NEAR(box.carry(now, false)[2], 2, 1e-9);
    EXPECT_NEAR(box.carry(now + DeviceMailbox::kUnattended, false)[2], 2, 1e-9);
    EXPECT_EQ(box.carry(now += DeviceMailbox::kUnattended + kExchangeTick, false)[2], 0);
}

TEST_F(Exchanged, AForceThatWasWithheldIsReportedAndAskedForAgain) {
    for (int i = 0; i < 3; ++i) tick(2);
    withhold = true;
    EXPECT_EQ(tick(2).force_hand_N, 0);
    EXPECT_EQ(carried_N[2], 0);
    withhold = false;
    const DeviceVector before_N = box.carry(now, false);
    EXPECT_NEAR(before_N[2], 2, 1e-9) << "the command knows";
    withhold = true;
    now += kExchangeTick;
    box.carry(now, true);
    EXPECT_EQ(box.carry(now, false)[2], 0) << "the command does not";
}

TEST_F(Exchanged, AWithheldForceIsReportedBeforeItComesBackWhoeverHearsOfItFirst) {
    for (int i = 0; i < 3; ++i) tick(2);
    box.carry(now += kExchangeTick, true);
    handle().take_stop(now);
    handle().command_force(now, 2);
    EXPECT_EQ(box.carry(now, false)[2], 0) << "the command does not know";
    EXPECT_EQ(tick(2).force_hand_N, 0);
    EXPECT_NEAR(box.carry(now, false)[2], 2, 1e-9) << "the command knows";
}

TEST_F(Exchanged, SilenceCostsTheForceAndThenTheTrial) {
    for (int i = 0; i < 3; ++i) tick(2);
    for (int i = 0; i < 25; ++i) {
        now += kExchangeTick;
        rest(2);
    }
    EXPECT_FALSE(rest(2).valid);
    EXPECT_EQ(box.carry(now, false)[2], 0);
    for (int i = 0; i < 300; ++i) {
        now += kExchangeTick;
        rest(2);
    }
    EXPECT_THAT(std::string(handle().fault()), HasSubstr("Device D1 has sent no usable position"));
    EXPECT_THAT(std::string(handle().fault()), HasSubstr("start thimble-master again"));
    handle().start_trial(now, {});
    EXPECT_FALSE(tick(2).valid) << "no force comes back without a restart";
    EXPECT_THAT(std::string(handle().fault()), HasSubstr("Device D1 has sent no usable position"));
}

TEST_F(Exchanged, ALossEndsEachTrialInItsWords) {
    for (int i = 0; i < 3; ++i) tick(2);
    box.lose("it is gone");
    box.lose("a later reason");
    EXPECT_FALSE(tick(2).valid);
    EXPECT_EQ(tick(2).force_hand_N, 0);
    EXPECT_EQ(carried_N[2], 0);
    EXPECT_THAT(std::string(handle().fault()), HasSubstr("Device D1: it is gone; then start"));
    handle().start_trial(now, {});
    tick(2);
    EXPECT_FALSE(handle().fault().empty());
    EXPECT_THAT(refusal([&] { handle().awaits(); }, ExitCode::kRunFailed), HasSubstr("it is gone"));
}

TEST_F(Exchanged, AShortPressIsNotMissed) {
    buttons = 2;
    tick(0);
    buttons = 0;
    tick(0);
    EXPECT_TRUE(handle().take_stop(now));
    EXPECT_FALSE(handle().take_stop(now));
    buttons = 1;
    tick(0);
    EXPECT_FALSE(handle().take_stop(now)) << "another button";
}

class ExchangedStrong : public Exchanged {
  protected:
    void SetUp() override {
        limit_N = 100;
        Exchanged::SetUp();
    }
};

TEST_F(ExchangedStrong, NoMoreIsReportedThanTheWordHolds) {
    for (int i = 0; i < 3; ++i) tick(80);
    EXPECT_NEAR(tick(80).force_hand_N, 52.4287, 1e-9);
    EXPECT_NEAR(carried_N[2], 52.4287, 1e-9);
}

class ExchangedFree : public Exchanged {
  protected:
    void SetUp() override {
        axis.lateral = LateralHold::kVirtual;
        axis.lateral_damping_Ns_per_m = 0;
    }
};

TEST_F(ExchangedFree, TheSpringAcrossTheAxisHoldsOnlyWithForce) {
    for (int i = 0; i < 3; ++i) tick(0);
    y_m = 0.001;
    for (int i = 0; i < 3; ++i) tick(0);
    EXPECT_EQ(carried_N[1], 0);
    handle().enable_force(now, true);
    y_m = 0.002;
    for (int i = 0; i < 3; ++i) tick(0);
    EXPECT_NEAR(carried_N[1], -1, 1e-9);
    handle().enable_force(now, false);
    tick(0);
    EXPECT_EQ(carried_N[1], 0);
}

TEST_F(ExchangedFree, EachSampleRenewsTheSpring) {
    for (int i = 0; i < 3; ++i) tick(0);
    handle().enable_force(now, true);
    tick(0);
    now += kExchangeTick;
    box.publish({0, 0.001, 0}, 0);
    handle().read(now);
    EXPECT_NEAR(box.carry(now, false)[1], -1, 1e-9) << "without a command";
}

}  // namespace
}  // namespace thimble
