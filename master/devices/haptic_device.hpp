// The second seam: a handle that is read and pushes back. One axis, z, positive into the tissue.
#pragma once

#include "common/time.hpp"

namespace thimble {

struct HandleSample {
    double position_hand_m = 0;  // encoder reading (quantised)
    double force_hand_N = 0;     // force the handle applies at this moment, positive pushes the hand out (-z)
};

class HapticDevice {
  public:
    virtual ~HapticDevice() = default;
    HapticDevice() = default;
    HapticDevice(const HapticDevice&) = delete;
    HapticDevice& operator=(const HapticDevice&) = delete;

    virtual HandleSample read(SessionTime now) = 0;

    // Held until the next command. The device clips at its own limit; read() says what it really applies.
    virtual void command_force(SessionTime now, double force_hand_N) = 0;
};

}  // namespace thimble
