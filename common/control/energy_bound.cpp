#include "common/control/energy_bound.hpp"

#include <algorithm>
#include <cmath>

namespace thimble {

void MemorylessBound::take(double travel_hand_m, double period_s, double force_N) {
    const double h_s = settings().sample_period_s;
    const double c = 2 * settings().device_damping_Ns_per_m / h_s;
    if (period_s == h_s) {
        reach_N_ = std::fabs(force_N + c * travel_hand_m);
        return;
    }
    // The same stored energy, with the damping of a longer period.
    const double squared = force_N * force_N + 2 * c * force_N * travel_hand_m +
                           c * c * travel_hand_m * travel_hand_m * h_s / period_s;
    reach_N_ = std::sqrt(std::max(0.0, squared));
}

double MemorylessBound::answer(double wanted_N) const { return std::clamp(wanted_N, -reach_N_, reach_N_); }

double EnergyStore::bounded_N(double wanted_N) const {
    const double most_N = std::sqrt(4 * settings_.device_damping_Ns_per_m * std::max(0.0, energy_J_) /
                                    settings_.sample_period_s);
    return std::clamp(wanted_N, -most_N, most_N);
}

}  // namespace thimble
