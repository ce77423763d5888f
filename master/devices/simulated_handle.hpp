// An omega.3-like handle with the virtual operator's hand on it: one physical system, integrated together.
//
// Its time is a grid of 0.1 ms (plant) and 1 ms (brain) that starts with the trial. A call at `now` first
// advances to the last grid point not after `now`, so the grid of the calls does not matter: whoever reads at
// 0.37 ms and at 1 ms gets the bits of whoever reads at 1 ms. A command or percept at the instant of a brain tick counts in that tick.
#pragma once

#include <optional>

#include "master/devices/handle_settings.hpp"
#include "master/devices/haptic_device.hpp"
#include "master/operator/virtual_operator.hpp"

namespace thimble {

class SimulatedHandle final : public HapticDevice, public OperatorPort {
  public:
    SimulatedHandle(const HandleSettings& settings, const OperatorParameters& parameters);

    HandleSample read(SessionTime now) override;
    // A force that is not a number counts as zero.
    void command_force(SessionTime now, double force_hand_N) override;
    // No motors to switch off, no button, and nothing that fails.
    void enable_force(SessionTime /*now*/, bool /*enabled*/) override {}
    bool take_stop(SessionTime /*now*/) override { return false; }
    SessionTime next_look() const override { return kNever; }
    std::string_view fault() const override { return {}; }

    void start_trial(SessionTime now, const OperatorTask& task) override;
    // Each percept replaces the last one whole; touch and beep are remembered.
    void perceive(SessionTime now, const Percept& percept) override;
    bool finished() const override;

    // Values that no real device has. All of the last grid point that was reached.
    double position_hand_m() const { return limb_.position_hand_m(); }  // before the encoder
    double force_hand_N() const { return force_hand_N_; }
    std::uint64_t refused_forces() const { return refused_forces_; }
    // Milliseconds left out because no call came for longer than a second.
    std::uint64_t skipped_ms() const { return skipped_ms_; }
    // Null before the first trial.
    const VirtualOperator* operator_in_trial() const { return operator_ ? &*operator_ : nullptr; }

  private:
    void advance(SessionTime now);

    HandleSettings settings_;
    OperatorParameters parameters_;
    double counts_per_m_;
    Limb limb_;
    std::optional<VirtualOperator> operator_;
    Percept percept_;
    SessionTime reached_{};  // grid point
    unsigned substep_ = 0;   // of the millisecond under way
    double force_hand_N_ = 0;
    std::uint64_t refused_forces_ = 0, skipped_ms_ = 0;
};

}  // namespace thimble
