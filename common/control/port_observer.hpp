// Work of the hand on a handle whose force is held between samples, and how wrong an encoder can make that account.
//     E_k = sum_{j<k} F_j (x_{j+1} - x_j)          exact for a held force, whatever happens between the samples
//                                                   (passivity observer: Hannaford and Ryu 2002)
//     |E_k(read) - E_k| <= Delta/2 (|F_0| + |F_{k-1}| + TV_k(F))     positions rounded to Delta; by Abel summation
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
        if (placed_) account(position_hand_m - position_hand_m_, force_held_N);
        placed_ = true;
        position_hand_m_ = position_hand_m;
    }

    double energy_in_J() const { return energy_in_J_; }
    // The most by which energy_in_J() can be wrong if positions were rounded to this step.
    double encoder_error_J(double step_hand_m) const {
        return 0.5 * step_hand_m * (first_N_ + std::fabs(last_N_) + variation_N_);
    }
    double variation_N() const { return variation_N_; }  // total, of the held force

  private:
    void account(double travel_hand_m, double force_N) {
        energy_in_J_ += force_N * travel_hand_m;
        if (forces_) {
            variation_N_ += std::fabs(force_N - last_N_);
        } else {
            first_N_ = std::fabs(force_N);
        }
        forces_ = true;
        last_N_ = force_N;
    }

    bool placed_ = false, forces_ = false;
    double position_hand_m_ = 0, energy_in_J_ = 0;
    double first_N_ = 0, last_N_ = 0, variation_N_ = 0;
};

}  // namespace thimble
