#include "stability/stability_map.hpp"

#include <cmath>

namespace thimble {
namespace {

constexpr double kMarginalGrowth = 0.1 / 6;  // per second

}  // namespace

GrowthClass growth_class(double growth_per_s) {
    if (std::abs(growth_per_s) < kMarginalGrowth) return GrowthClass::kMarginal;
    return growth_per_s > 0 ? GrowthClass::kUnstable : GrowthClass::kStable;
}

const char* name_of(GrowthClass growth) {
    switch (growth) {
        case GrowthClass::kStable:
            return "stable";
        case GrowthClass::kMarginal:
            return "marginal";
        case GrowthClass::kUnstable:
            return "unstable";
    }
    return "?";
}

std::vector<MapCell> map_column(const MapPlan& plan, std::size_t delay_index) {
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
