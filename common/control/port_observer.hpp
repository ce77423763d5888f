// Work of the hand on a handle whose force is held between samples.
//     E_k = sum_{j<k} F_j (x_{j+1} - x_j)          exact for a held force, whatever happens between the samples
//                                                   (passivity observer: Hannaford and Ryu 2002)
// F positive pushes the hand out (-z), so pushing in against it is work put in, E > 0. SI units.
#pragma once

#include <cmath>

namespace thimble {

class PortObserver {
  public:
    void clear() { *this = {}; }

    // Each sample, in order: where the hand is, and which force was held on the way there. The first one only says where
    // the hand is. Values that are no number are left out.
    void add(double position_hand_m, double force_held_N) {
        if (!std::isfinite(position_hand_m) || !std::isfinite(force_held_N)) return;
        if (placed_) energy_in_J_ += force_held_N * (position_hand_m - position_hand_m_);
        placed_ = true;
        position_hand_m_ = position_hand_m;
    }

    double energy_in_J() const { return energy_in_J_; }

  private:
    bool placed_ = false;
    double position_hand_m_ = 0, energy_in_J_ = 0;
};

}  // namespace thimble
