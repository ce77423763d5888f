// Numbers and tissue for property tests, drawn evenly whatever size RapidCheck is at.
#pragma once

#include <cmath>
#include <vector>

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

struct PathSample {
    double duration_s;
    double needle_m;
};
using Path = std::vector<PathSample>;

// Strokes, holds and jitter about the surface.
inline Path random_path(double rest_m) {
    Path path;
    double needle_m = rest_m - 0.01;
    for (int i = 0; i < 40; ++i) {
        const double kind = between(0, 1);
        if (kind < 0.5) needle_m += between(-0.01, 0.01);
        if (kind > 0.8) needle_m = rest_m + between(-0.03, 0.03);
        path.push_back({decade(-4, 0), needle_m});
    }
    return path;
}

}  // namespace thimble
