// A simulated handle that a person's pointer draws through a virtual coupling: no operator's limb, no motor. The person
// feels nothing in the hand but sees the needle give way, which is what HF can be with a mouse.
//     m_d x" = F_c - b_c x' - b_d x' - F_f - F_dev,   F_c = k_c (x_wanted - x) within +-force_limit_N, 0 if let go
// F_f, F_dev and signs as in limb.hpp; z positive into the tissue. The damper stands between handle and ground, not
// between handle and pointer: a pointer moves in steps of a screen's frame, and their derivative would be blows.
//
// Let go (not engaged, or no input for kLetGoAfter) is no spring and the damper alone. A spring to the last wanted place
// would push on for somebody who is no longer there, and with delay oscillate by itself; a handle without a spring can
// only lose energy. It rests where friction stops it, and the needle with it, commands going on.
//
// Time is a grid of 0.1 ms that starts with the trial; a call at `now` advances to the last grid point not after it. A wanted place holds from the grid point that had been reached when it arrived.
#pragma once

#include "master/devices/software_handle.hpp"

namespace thimble {

class PointerHandle : public SoftwareHandle, public HandFollower {
  public:
    static constexpr Duration kLetGoAfter = std::chrono::milliseconds{100};

    explicit PointerHandle(const HandleSettings& settings) : SoftwareHandle(settings) {}

    // At rest at z = 0, let go.
    void start_trial(SessionTime now, const OperatorTask& task) override;
    HandFollower* follower() override { return this; }
    void follow(SessionTime now, const HandInput& input) override;

    double position_hand_m() const override { return position_m_; }
    double velocity_hand_m_per_s() const { return velocity_m_per_s_; }

  private:
    void advance(SessionTime now) override;
    void step();
    double pull_N() const;

    bool in_trial_ = false;
    SessionTime reached_{};  // grid point
    double position_m_ = 0, velocity_m_per_s_ = 0;
    double bristle_ = 0;  // of the friction, in [-1, 1]
    double wanted_m_ = 0;
    SessionTime let_go_{};  // the spring holds before this
};

}  // namespace thimble
