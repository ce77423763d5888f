#include "slave_sim/fixture.hpp"

#include <gtest/gtest.h>

namespace thimble {
namespace {

TEST(Fixture, PushesBackWhatIsBeyondIt) {
    const Fixture fixture({3000, 0.123});
    const FixtureContact c = fixture.touch(0.124);
    EXPECT_EQ(c.position_proxy_m, 0.123);
    EXPECT_NEAR(c.penetration_m, 0.001, 1e-17);
    EXPECT_NEAR(c.force_N, -3, 1e-12);
}

TEST(Fixture, LetsTheNeedleComeUpToIt) {
    const Fixture fixture({3000, 0.123});
    for (const double needle_m : {-1.0, 0.0, 0.1229, 0.123}) {
        const FixtureContact c = fixture.touch(needle_m);
        EXPECT_EQ(c.position_proxy_m, needle_m);
        EXPECT_EQ(c.penetration_m, 0);
        EXPECT_EQ(c.force_N, 0);
    }
}

TEST(Fixture, AbsentItIsNotFelt) {
    Fixture fixture({3000, 0.123});
    fixture.place(0.123, false);
    EXPECT_FALSE(fixture.present());
    EXPECT_EQ(fixture.touch(0.2).force_N, 0);
    EXPECT_EQ(fixture.touch(0.2).penetration_m, 0);
    EXPECT_EQ(fixture.touch(0.2).position_proxy_m, 0.2);
}

TEST(Fixture, MovesWhereItIsPut) {
    Fixture fixture({3000, 0.123});
    fixture.place(0.1, true);
    EXPECT_EQ(fixture.position_m(), 0.1);
    EXPECT_NEAR(fixture.touch(0.123).force_N, -69, 1e-10);
}

}  // namespace
}  // namespace thimble
