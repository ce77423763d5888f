// The session's side of the operator who holds the handle. The virtual operator implements it in software; for a
// person the same calls mean "start", "you would now feel this", and "done?".
#pragma once

#include <cstdint>

#include <boost/core/noncopyable.hpp>

#include "common/messages.hpp"
#include "common/time.hpp"

namespace thimble {

struct OperatorTask {
    std::uint64_t study_seed = 0;
    std::uint32_t experiment = 0;
    std::uint32_t subject = 0;
    std::uint32_t trial = 0;  // counted from 1 within the subject
    Modality modality = Modality::kHF;
};

class OperatorPort : boost::noncopyable {
  public:
    virtual ~OperatorPort() = default;

    // Hand at rest at z = 0, needle outside the tissue; the trial starts at `now`.
    virtual void start_trial(SessionTime now, const OperatorTask& task) = 0;
    // The percepts of skin, eyes and ears (the handle's force reaches the hand through HapticDevice instead).
    virtual void perceive(SessionTime now, const Percept& percept) = 0;
    // True once the needle has been withdrawn after the beep.
    virtual bool finished() const = 0;
};

// Receives the place of a person's hand by mouse, trackpad or gamepad, for a device without a handle.
class HandFollower : boost::noncopyable {
  public:
    virtual ~HandFollower() = default;

    // Each input replaces the last one whole.
    virtual void follow(SessionTime now, const HandInput& input) = 0;
};

}  // namespace thimble
