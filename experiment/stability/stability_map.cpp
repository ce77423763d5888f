#include "experiment/stability/stability_map.hpp"

#include <cmath>

#include <fmt/format.h>

namespace thimble {
namespace {

constexpr double kMarginalGrowth = 0.1 / 6;  // per second

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

}  // namespace

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
        if (std::abs(cell.growth_per_s) >= kMarginalGrowth) {
            cell.growth = cell.growth_per_s > 0 ? GrowthClass::kUnstable : GrowthClass::kStable;
        }
        cell.hold = measured_hold(conditions, {});
        column.push_back(cell);
    }
    return column;
}

std::string map_header() {
    return "delay_s,stiffness_N_per_m,critical_stiffness_N_per_m,growth_per_s,linear,outcome,energy_grows,"
           "peak_to_peak_m,losses_per_s,energy_J\n";
}

std::string map_row(const MapCell& c) {
    return fmt::format("{:.9g},{:.9g},{:.9g},{:.6g},{},{},{},{:.6g},{:.4g},{:.6g}\n", c.delay_s,
                       c.stiffness_N_per_m, c.critical_stiffness_N_per_m, c.growth_per_s, name_of(c.growth),
                       static_cast<char>(c.hold.label), c.hold.energy_grows ? "yes" : "no",
                       c.hold.peak_to_peak_m, c.hold.losses_per_s, c.hold.energy_J);
}

}  // namespace thimble
