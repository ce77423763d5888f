// From forces on fingers to the two motors of a gamepad, for the window and for the page. Pure.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"

namespace thimble {

// As in FF_RUMBLE: 0 is off, 65535 as strong as it gets.
struct RumbleLevels {
    std::uint16_t strong = 0, weak = 0;
    bool operator==(const RumbleLevels&) const = default;
};

// A motor at its strongest. As the drawn fingertip: a nail's colour ceases to change at a few newton.
inline constexpr double kFullRumble_N = 4;
// Hysteresis, N: noise about zero makes no motor stutter.
inline constexpr double kRumbleStarts_N = 0.10, kRumbleStops_N = 0.05;
// A command to the motors ends by itself after so long, even if this program has died.
inline constexpr Duration kRumbleLasts = std::chrono::milliseconds{500};
// Weaker, most motors do not turn at all.
inline constexpr double kWeakestRumble = 0.125;

// From what presses on a finger to the motors: pure, with time as an argument. The index finger is the strong (slow) motor, the
// thumb the weak (quick) one.
class RumblePace {
  public:
    // Each update is a transfer over USB or radio, so that there are at most 50 per second.
    static constexpr Duration kPeriod = std::chrono::milliseconds{20};
    // Period of repeats: a command ends by itself after kRumbleLasts, so that no motor runs on when this program has
    // ended.
    static constexpr Duration kSayAgain = std::chrono::milliseconds{250};

    // Forces on index finger and thumb, N, 0 or more (NaN is 0). The command for the device now. None if the device
    // has it already, or got another one too recently.
    std::optional<RumbleLevels> next(SessionTime now, double index_N, double thumb_N);
    // The device has been stopped, or is another one.
    void forget();

  private:
    class Motor {
      public:
        std::uint16_t level(double force_N);

      private:
        bool turns_ = false;
    };
    bool worth_saying(SessionTime now, const RumbleLevels& levels) const;

    Motor strong_, weak_;
    RumbleLevels said_;
    SessionTime said_at_{};
    bool said_anything_ = false;
};

}  // namespace thimble
