// No cell of the map farther than 2 % from the boundary is on the wrong side of it.
#include "stability/stability_map.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace thimble {
namespace {

TEST(StabilityMap, NoCellIsOnTheWrongSide) {
    for (const HeldMass& hand : {HeldMass{0.15, 3, 300}, HeldMass{1, 20, 500}}) {
        MapPlan plan;
        plan.hand = hand;
        plan.delays_s = {0, 0.005, 0.0503, 0.2};  // the third is no whole number of steps
        plan.stiffness_N_per_m.reserve(21);
        for (int i = 0; i <= 20; ++i) plan.stiffness_N_per_m.push_back(45 * std::pow(2000, i / 20.0));
        for (std::size_t column = 0; column < plan.delays_s.size(); ++column) {
            int stable = 0, unstable = 0;
            for (const MapCell& cell : map_column(plan, column)) {
                const double apart = std::log(cell.stiffness_N_per_m / cell.critical_stiffness_N_per_m);
                stable += cell.growth == GrowthClass::kStable;
                unstable += cell.growth == GrowthClass::kUnstable;
                if (std::abs(apart) < 0.02 || cell.growth == GrowthClass::kMarginal) continue;
                EXPECT_EQ(cell.growth == GrowthClass::kUnstable, apart > 0)
                    << cell.delay_s << ' ' << cell.stiffness_N_per_m << ' ' << cell.growth_per_s;
            }
            EXPECT_GT(stable, 0);
            EXPECT_GT(unstable, 0);
        }
    }
}

}  // namespace
}  // namespace thimble
