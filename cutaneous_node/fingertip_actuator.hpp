// The third seam: a wearable device that presses the index finger and the thumb, and can never pull.
#pragma once

#include <string_view>

#include <boost/core/noncopyable.hpp>

#include "common/messages.hpp"
#include "common/time.hpp"

namespace thimble {

// The hand on the handle, or the other one (CCF).
enum class Hand : std::uint8_t { kActing, kOther };

struct FingertipForce {
    Finger finger = Finger::kNone;  // kNone: both cables slack
    double force_N = 0;             // >= 0
    // Time of the force: for a simulated device when it was commanded, for a real one when it was measured.
    SessionTime sample_time{};
};

// All calls are pure virtual: a wrapper that forgot one would hide it.
class FingertipActuator : boost::noncopyable {
  public:
    virtual ~FingertipActuator() = default;

    // Target for one finger; the other goes slack. Clipped to [0, limit] by the device. `now` never
    // decreases.
    virtual void command(SessionTime now, Finger finger, double force_N) = 0;
    // The force on the skin at `now`.
    virtual FingertipForce output(SessionTime now) = 0;
    // Both cables slack and nothing in flight (start of a trial, stop).
    virtual void release(SessionTime now) = 0;
    // From now on commands are for this hand's fingers. The other hand's are released. A device that is worn on one hand stays there.
    virtual void use_hand(SessionTime now, Hand hand) = 0;
    // For a device with messages of its own: takes those that have arrived, sends what is due. Never blocks.
    virtual void tick(SessionTime now) = 0;
    virtual SessionTime next_wakeup() const = 0;
    // Empty while the device works; else which part failed, why, and what to do. A failed device presses no finger.
    virtual std::string_view fault() const = 0;
};

}  // namespace thimble
