#include "slave_sim/elements/forbidden_region.hpp"

#include <gtest/gtest.h>

namespace thimble {
namespace {

TEST(ForbiddenRegion, PushesBackWhatIsBeyondIt) {
    const ForbiddenRegion fixture({3000, 0, 0.123, {}});
    const FixtureContact c = fixture.touch(0.124);
    EXPECT_EQ(c.position_proxy_m, 0.123);
    EXPECT_NEAR(c.penetration_m, 0.001, 1e-17);
    EXPECT_NEAR(c.force_N, -3, 1e-12);
}

TEST(ForbiddenRegion, LetsTheNeedleComeUpToIt) {
    const ForbiddenRegion fixture({3000, 0, 0.123, {}});
    for (const double needle_m : {-1.0, 0.0, 0.1229, 0.123}) {
        const FixtureContact c = fixture.touch(needle_m);
        EXPECT_EQ(c.position_proxy_m, needle_m);
        EXPECT_EQ(c.penetration_m, 0);
        EXPECT_EQ(c.force_N, 0);
    }
}

TEST(ForbiddenRegion, AbsentItIsNotFelt) {
    ForbiddenRegion fixture({3000, 0, 0.123, {}});
    fixture.place(0.123, false);
    EXPECT_FALSE(fixture.present());
    EXPECT_EQ(fixture.touch(0.2).force_N, 0);
    EXPECT_EQ(fixture.touch(0.2).penetration_m, 0);
    EXPECT_EQ(fixture.touch(0.2).position_proxy_m, 0.2);
}

TEST(ForbiddenRegion, MovesWhereItIsPut) {
    ForbiddenRegion fixture({3000, 0, 0.123, {}});
    fixture.place(0.1, true);
    EXPECT_EQ(fixture.position_m(), 0.1);
    EXPECT_NEAR(fixture.touch(0.123).force_N, -69, 1e-10);
}

}  // namespace
}  // namespace thimble
