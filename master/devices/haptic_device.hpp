// The second seam: a handle that is read and pushes back. One axis, z, positive into the tissue.
#pragma once

#include <string_view>

#include <boost/core/noncopyable.hpp>

#include "common/time.hpp"

namespace thimble {

struct HandleSample {
    double position_hand_m = 0;  // encoder reading (quantised)
    double force_hand_N = 0;     // force the handle applies at this moment, positive pushes the hand out (-z)
    bool valid = true;           // false: the device has failed, and these are no measurements
};

// All calls are pure virtual: a wrapper that forgot one would hide a button or a fault.
class HapticDevice : boost::noncopyable {
  public:
    virtual ~HapticDevice() = default;

    virtual HandleSample read(SessionTime now) = 0;

    // Held until the next command. The device clips at its own limit; read() gives the force that it really applies.
    virtual void command_force(SessionTime now, double force_hand_N) = 0;

    // Allows forces from now on. Without (CF, CCF, VF, between trials) a real device has no motor current and is an
    // encoder only, as in the paper.
    virtual void enable_force(SessionTime now, bool enabled) = 0;

    // True if the emergency-stop button is down, or was since the last call.
    virtual bool take_stop(SessionTime now) = 0;
    // The latest time of the next take_stop(), so that a short press is seen; kNever: the device remembers presses.
    virtual SessionTime next_look() const = 0;

    // Empty while the device works; else which device failed, why, and what to do. From then on it applies no force
    // and read() is not valid.
    virtual std::string_view fault() const = 0;
};

}  // namespace thimble
