// A map: delay against stiffness, measured class by class, with the theory beside each cell.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "common/shared_values.hpp"
#include "stability/loop_measures.hpp"

namespace thimble {

inline constexpr double kMarginalGrowth = 0.1 / 6;  // per second

struct MapPlan {
    HeldMass hand;
    std::vector<double> delays_s;
    std::vector<double> stiffness_N_per_m;
    double step_s = 1e-3;
    double press_N = 5;
    double force_limit_N = kHandleFullScale_N;
    double encoder_step_m = 1e-5;
};

// Of the linear loop. Marginal: neither grown nor faded by a tenth within the six seconds it was watched.
enum class GrowthClass : unsigned char { kStable, kMarginal, kUnstable };
inline GrowthClass growth_class(double growth_per_s) {
    if (std::abs(growth_per_s) < kMarginalGrowth) return GrowthClass::kMarginal;
    return growth_per_s > 0 ? GrowthClass::kUnstable : GrowthClass::kStable;
}

// "stable", "marginal", "unstable"
inline const char* name_of(GrowthClass growth) {
    constexpr std::array kNames{"stable", "marginal", "unstable"};
    return kNames[static_cast<std::size_t>(growth)];
}

struct MapCell {
    double delay_s = 0;
    double stiffness_N_per_m = 0;
    double critical_stiffness_N_per_m = 0;  // theory of the sampled loop at this delay
    double growth_per_s = 0;                // measured, linear, no encoder
    GrowthClass growth = GrowthClass::kMarginal;
    HoldOutcome hold;  // measured with wall, force limit and encoder
};
// All cells of one delay.
inline std::vector<MapCell> map_column(const MapPlan& plan, std::size_t delay_index) {
    LoopConditions conditions;
    conditions.loop = {plan.hand, 1, plan.delays_s.at(delay_index), plan.step_s};
    conditions.one_sided = true;
    conditions.force_limit_N = plan.force_limit_N;
    conditions.press_N = plan.press_N;
    conditions.encoder_step_m = plan.encoder_step_m;
    const double critical = critical_sampled_stiffness(conditions.loop).stiffness_N_per_m;
    std::vector<MapCell> column;
    column.reserve(plan.stiffness_N_per_m.size());
    for (const double stiffness : plan.stiffness_N_per_m) {
        conditions.loop.stiffness_N_per_m = stiffness;
        MapCell cell;
        cell.delay_s = conditions.loop.delay_s;
        cell.stiffness_N_per_m = stiffness;
        cell.critical_stiffness_N_per_m = critical;
        cell.growth_per_s = measured_growth_per_s(conditions.loop, 0);
        cell.growth = growth_class(cell.growth_per_s);
        cell.hold = measured_hold(conditions, {});
        column.push_back(cell);
    }
    return column;
}

}  // namespace thimble
