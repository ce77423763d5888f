// What a device that has no handle of its own needs: where a person's hand is, by mouse, trackpad or gamepad.
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
