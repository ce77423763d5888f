// The third seam: a wearable device that presses the index finger and the thumb, and can never pull.
#pragma once

#include <string_view>

#include "common/messages.hpp"
#include "common/time.hpp"

namespace thimble {

struct FingertipForce {
    Finger finger = Finger::kNone;  // kNone: both cables slack
    double force_N = 0;             // >= 0
    SessionTime sample_time{};      // when the force that is pressed now was commanded
};

class FingertipActuator {
  public:
    virtual ~FingertipActuator() = default;
    FingertipActuator() = default;
    FingertipActuator(const FingertipActuator&) = delete;
    FingertipActuator& operator=(const FingertipActuator&) = delete;

    // Target for one finger; the other goes slack. Clipped to [0, limit] by the device. `now` never
    // decreases.
    virtual void command(SessionTime now, Finger finger, double force_N) = 0;
    // What the skin gets at `now`.
    virtual FingertipForce output(SessionTime now) = 0;
    // Both cables slack and nothing in flight (start of a trial, stop).
    virtual void release(SessionTime now) = 0;
    // Which device has failed, why and what to do about it; empty: none. Then it presses nothing.
    virtual std::string_view trouble() const { return {}; }
};

}  // namespace thimble
