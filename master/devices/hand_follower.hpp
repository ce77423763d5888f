// Receives the place of a person's hand by mouse, trackpad or gamepad, for a device without a handle.
#pragma once

#include "common/messages.hpp"
#include "common/time.hpp"

namespace thimble {

class HandFollower {
  public:
    virtual ~HandFollower() = default;
    HandFollower() = default;
    HandFollower(const HandFollower&) = delete;
    HandFollower& operator=(const HandFollower&) = delete;

    // Each input replaces the last one whole.
    virtual void follow(SessionTime now, const HandInput& input) = 0;
};

}  // namespace thimble
