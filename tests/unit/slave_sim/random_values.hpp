// Numbers and tissue for property tests, drawn evenly whatever size RapidCheck is at.
#pragma once

#include <cmath>

#include <rapidcheck.h>

#include "slave_sim/tissue_solver.hpp"

namespace thimble {

inline double between(double low, double high) {
    return low + (high - low) * 1e-6 * *rc::gen::resize(100, rc::gen::inRange(0, 1000001));
}

inline double decade(double low, double high) { return std::pow(10.0, between(low, high)); }

// Over decades of each parameter, stiffness from 10^softest N/m on; undamped now and then. The surface rests
// where the paper's does.
inline TissueParameters random_tissue(double softest) {
    TissueParameters p;
    p.mass_kg = decade(-2, 1);
    p.stiffness_N_per_m = decade(softest, 2);
    p.damping_Ns_per_m = between(0, 1) < 0.1 ? 0 : decade(-1, 1);
    p.drag_Ns_per_m = decade(-2, 0.5);
    p.puncture_force_N = decade(-2, 0);
    return p;
}

}  // namespace thimble
