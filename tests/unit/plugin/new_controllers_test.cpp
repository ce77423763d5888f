// Controllers that measure the network, and four channels, reckoned by hand.
#include <gtest/gtest.h>

#include "common/control/age_estimate.hpp"
#include "common/control/controller_ends.hpp"

namespace thimble::test {
namespace {

ControlSettings of(Compensator compensator) {
    ControlSettings settings;
    settings.compensator = compensator;
    return settings;
}

thimble_feedback pushes(double force_N, double age_s, double hand_m = 0.04) {
    thimble_feedback feedback{};
    feedback.position_hand_m = hand_m;
    feedback.force_total_hand_N = feedback.force_fixture_hand_N = force_N;
    feedback.age_s = age_s;
    feedback.known = 1;
    return feedback;
}

TEST(AgeEstimate, JitterIsThatOfRfc3550) {
    AgeEstimate age;
    age.start(0.05);
    EXPECT_EQ(age.mean_s(), 0.05);
    age.add(0.02);
    EXPECT_EQ(age.mean_s(), 0.02) << "the first age counts as it is";
    age.add(0.036);
    EXPECT_DOUBLE_EQ(age.mean_s(), 0.022);
    EXPECT_DOUBLE_EQ(age.jitter_s(), 0.001);
    age.add(-1);
    EXPECT_DOUBLE_EQ(age.mean_s(), 0.022);
}

// K (T + h / 2) <= b: 0.8 x 15 / (9000 x 50.5 ms), and all of the force without delay.
TEST(PredictedShare, IsTheLargestThatTheMeasuredDelayAllows) {
    ControlSettings settings = of(Compensator::kPredictedShare);
    EXPECT_EQ(settings.hand_share(), 0) << "the skin gets all";
    HandleEnd end(settings, {});
    end.start(std::chrono::milliseconds{200});
    end.receive(pushes(10, 0.05));
    EXPECT_DOUBLE_EQ(end.force_N(), 10 * 0.8 * 15 / (9000 * 0.0505));
    end.start({});
    end.receive(pushes(10, 0));
    EXPECT_EQ(end.force_N(), 10);
}

TEST(AdaptiveFixture, APlaneMovesMoreSlowlyWhereTheNetworkJitters) {
    const auto moved_m = [](double jitter_s) {
        HandleEnd end(of(Compensator::kAdaptiveFixture), {});
        end.start({});
        for (int i = 0; i < 200; ++i) {
            end.sample(SessionTime{std::chrono::milliseconds{i}}, 0.045, 0, 0);
            // 3 N at 40 mm: the plane is at 39 mm, and the hand is inside when it learns that.
            end.receive(pushes(3, i % 2 == 0 ? 0.05 : 0.05 + jitter_s));
            end.force_N();
        }
        return end.force_N() / 3000;  // how far the plane has left the hand
    };
    EXPECT_NEAR(moved_m(0), 200 * 1e-3 * 0.02, 3e-5);
    EXPECT_LT(moved_m(0.02), 0.5 * moved_m(0));
}

TEST(FourChannel, TheNeedleIsAtTheHandWhereTheForcesAgree) {
    SlaveEnd end(of(Compensator::kFourChannel), {});
    end.start();
    NeedleWave message;
    message.command.position_hand_m = 0.041;
    message.waves.wave_root_W[0] = 3;  // N, at the handle
    message.waves.count = 1;
    ASSERT_EQ(end.receive(message, true), 1U);
    EXPECT_NEAR(end.step_hand_m({0.04, 3000, 0}), 0.041, 1e-12) << "3000 N/m x 1 mm are these 3 N";
    EXPECT_NEAR(end.step_hand_m({0.05, 3000, 1}), 0.041 + 2.0 / 20000, 1e-12);
    EXPECT_NEAR(end.step_hand_m({0.04, 9000, 0}), 0.04 + (1e-3 + 3.0 / 20000) * 20 / 29, 1e-12);
    EXPECT_EQ(end.receive(message, false), 0U) << "an older sample moves nothing";
    end.hold();
    EXPECT_NEAR(end.step_hand_m({1, 0, 0}), 0.041, 1e-12);
}

}  // namespace
}  // namespace thimble::test
