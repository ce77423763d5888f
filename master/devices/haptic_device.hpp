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

// Every call is pure: a wrapper that forgot to pass one on would compile, and a button or a fault would vanish in it.
class HapticDevice : boost::noncopyable {
  public:
    virtual ~HapticDevice() = default;

    virtual HandleSample read(SessionTime now) = 0;

    // Held until the next command. The device clips at its own limit; read() says what it really applies.
    virtual void command_force(SessionTime now, double force_hand_N) = 0;

    // Whether a force may be commanded in what follows. Where it may not (CF, CCF, VF, between trials) a real device has no current
    // in its motors and is an encoder only, as in the paper.
    virtual void enable_force(SessionTime now, bool enabled) = 0;

    // A button of the device that means "stop everything" is down, or has been since the last call.
    virtual bool take_stop(SessionTime now) = 0;
    // When a button has to be looked at by take_stop(), lest a short press is missed; kNever: the device notes presses by itself.
    virtual SessionTime next_look() const = 0;

    // Empty while the device works. Then: which device, what happened, what to do; it applies no force and read() is not
    // valid from the moment at which this is not empty.
    virtual std::string_view fault() const = 0;
};

}  // namespace thimble
