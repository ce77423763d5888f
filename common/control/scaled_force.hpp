// A share of the force for the hand, the rest for the skin (the paper's future work; Pacchierotti, Tirmizi, Bianchini and
// Prattichizzo, IROS 2013 and ToH 2015). The loop through the handle has the share's stiffness alone, so a share below the
// critical one is stable, and the skin closes no mechanical loop.
//     F_hand = sat(share F),   F_skin = F - share F
// The share comes before the saturation: a saturated force, scaled, ends at share x limit, and whoever pushes harder than
// that pushes through, which looks stable at every share.
#pragma once

#include <algorithm>

namespace thimble {

struct ScaledForce {
    double share = 1;  // 0 to 1

    double hand_N(double force_N, double limit_N) const {
        return std::clamp(share * force_N, -limit_N, limit_N);
    }
    double skin_N(double force_N) const { return (1 - share) * force_N; }
};

}  // namespace thimble
