// A map: delay against stiffness, measured class by class, with the theory beside each cell.
#pragma once

#include <cstddef>
#include <vector>

#include "common/shared_values.hpp"
#include "stability/loop_measures.hpp"

namespace thimble {

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
GrowthClass growth_class(double growth_per_s);
const char* name_of(GrowthClass growth);  // "stable", "marginal", "unstable"

struct MapCell {
    double delay_s = 0;
    double stiffness_N_per_m = 0;
    double critical_stiffness_N_per_m = 0;  // theory of the sampled loop at this delay
    double growth_per_s = 0;                // measured, linear, no encoder
    GrowthClass growth = GrowthClass::kMarginal;
    HoldOutcome hold;  // measured with wall, force limit and encoder
};
// All cells of one delay.
std::vector<MapCell> map_column(const MapPlan& plan, std::size_t delay_index);

}  // namespace thimble
