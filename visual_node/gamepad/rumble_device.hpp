// The motors of a gamepad, by Linux's force feedback (EVIOCSFF with FF_RUMBLE; Documentation/input/ff.rst). One effect, which is
// replaced and played again at each change. Never throws: a gamepad that cannot, or may not, is silent, and notice() says why.
#pragma once

#include <filesystem>
#include <string>

#include "visual_node/gamepad/rumble_pace.hpp"

namespace thimble {

class RumbleDevice {
  public:
    // The vibration of set() stops by itself after so long, even if this program has died.
    static constexpr Duration kLasts = std::chrono::milliseconds{500};

    RumbleDevice() = default;
    // `event`: /dev/input/eventN.
    explicit RumbleDevice(const std::filesystem::path& event);
    ~RumbleDevice() { close(); }
    RumbleDevice(RumbleDevice&& other) noexcept;
    RumbleDevice& operator=(RumbleDevice&& other) noexcept;

    bool ready() const { return file_ >= 0; }
    // Why it is not ready, for people; empty if it is, or was never opened.
    const std::string& notice() const { return notice_; }
    // Both zero stops the motors. A device that has gone is no longer ready().
    void set(const RumbleLevels& levels);

  private:
    bool upload(const RumbleLevels& levels);
    bool play(int times);
    void fail(const std::string& what);
    void close();

    int file_ = -1;
    std::int16_t effect_ = -1;  // none yet
    std::string event_, notice_;
};

}  // namespace thimble
