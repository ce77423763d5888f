// Work of the hand on the handle, counted as a passivity observer does (Hannaford and Ryu 2002):
//     E = sum over samples of F (x - x_before)
// F: the force that the handle applied on the way to x, positive pushes the hand out (-z), so that pushing in against it is
// work. What gives out more than it got, E < 0, is not passive. SI units.
#pragma once

#include "master/devices/haptic_device.hpp"

namespace thimble {

class PortEnergy {
  public:
    void clear() { *this = {}; }
    // Each sample of a trial, in order. The first one only says where the handle is.
    void add(const HandleSample& sample) {
        if (placed_) energy_in_J_ += sample.force_hand_N * (sample.position_hand_m - position_m_);
        placed_ = true;
        position_m_ = sample.position_hand_m;
        force_hand_N_ = sample.force_hand_N;
    }
    double energy_in_J() const { return energy_in_J_; }
    double force_hand_N() const { return force_hand_N_; }  // of the newest sample

  private:
    bool placed_ = false;
    double position_m_ = 0, force_hand_N_ = 0, energy_in_J_ = 0;
};

}  // namespace thimble
