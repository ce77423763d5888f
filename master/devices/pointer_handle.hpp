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

#include "master/devices/hand_follower.hpp"
#include "master/devices/handle_settings.hpp"
#include "master/devices/haptic_device.hpp"
#include "master/operator/operator_port.hpp"

namespace thimble {

class PointerHandle final : public HapticDevice, public OperatorPort, public HandFollower {
  public:
    static constexpr Duration kLetGoAfter = std::chrono::milliseconds{100};

    explicit PointerHandle(const HandleSettings& settings);

    HandleSample read(SessionTime now) override;
    // A force that is not a number counts as zero.
    void command_force(SessionTime now, double force_hand_N) override;
    // No motors to switch off, no button, and nothing that fails.
    void enable_force(SessionTime /*now*/, bool /*enabled*/) override {}
    bool take_stop(SessionTime /*now*/) override { return false; }
    SessionTime next_look() const override { return kNever; }
    std::string_view fault() const override { return {}; }

    // At rest at z = 0, let go.
    void start_trial(SessionTime now, const OperatorTask& task) override;
    void perceive(SessionTime /*now*/, const Percept& /*percept*/) override {}  // a person has eyes
    // A pointer does not know what the person is up to: the session sees the needle withdrawn.
    bool finished() const override { return false; }

    void follow(SessionTime now, const HandInput& input) override;

    // Of the last grid point that was reached; before the encoder.
    double position_hand_m() const { return position_m_; }
    double velocity_hand_m_per_s() const { return velocity_m_per_s_; }
    std::uint64_t refused_forces() const { return refused_forces_; }

  private:
    void advance(SessionTime now);
    void step();
    double pull_N() const;

    HandleSettings settings_;
    double counts_per_m_;
    bool in_trial_ = false;
    SessionTime reached_{};  // grid point
    double position_m_ = 0, velocity_m_per_s_ = 0;
    double bristle_ = 0;  // of the friction, in [-1, 1]
    double force_hand_N_ = 0;
    double wanted_m_ = 0;
    SessionTime let_go_{};  // the spring holds before this
    std::uint64_t refused_forces_ = 0;
};

}  // namespace thimble
