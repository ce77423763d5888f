// Work of the hand on the handle, counted as a passivity observer does (port_observer.hpp), from the handle's samples. A port that gives out more than it got, E < 0, is not passive. SI units.
#pragma once

#include "common/control/port_observer.hpp"
#include "master/devices/haptic_device.hpp"

namespace thimble {

class PortEnergy {
  public:
    void clear() { *this = {}; }
    // Each sample of a trial, in order. The first one only says where the handle is.
    void add(const HandleSample& sample) {
        observer_.add(sample.position_hand_m, sample.force_hand_N);
        force_hand_N_ = sample.force_hand_N;
    }
    double energy_in_J() const { return observer_.energy_in_J(); }
    double force_hand_N() const { return force_hand_N_; }  // of the newest sample

  private:
    PortObserver observer_;
    double force_hand_N_ = 0;
};

}  // namespace thimble
