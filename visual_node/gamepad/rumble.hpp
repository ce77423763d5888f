// The two motors of a gamepad.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include <boost/core/noncopyable.hpp>

#include "visual_node/gamepad/rumble_pace.hpp"

namespace thimble {

// The motors of a gamepad, by Linux's force feedback (EVIOCSFF with FF_RUMBLE; Documentation/input/ff.rst). One effect, which is
// replaced and played again at each change. Never throws: a gamepad that cannot, or may not, is silent, and notice() says why.
class RumbleDevice : boost::noncopyable {
  public:
    // `event`: /dev/input/eventN.
    explicit RumbleDevice(const std::filesystem::path& event);
    ~RumbleDevice();

    bool ready() const { return file_ >= 0; }
    // Why it is not ready, for people; empty if it is.
    const std::string& notice() const { return notice_; }
    // For kRumbleLasts. Both zero stops the motors. A device that has gone is no longer ready().
    void set(const RumbleLevels& levels);

  private:
    bool upload(const RumbleLevels& levels);
    bool play(int times);
    void fail(const std::string& what);

    int file_ = -1;
    std::int16_t effect_ = -1;  // none yet
    std::string event_, notice_;
};

}  // namespace thimble
