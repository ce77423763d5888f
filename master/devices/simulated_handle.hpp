// An omega.3-like handle with the virtual operator's hand on it: one physical system, integrated together.
//
// Its time is a grid of 0.1 ms (plant) and 1 ms (brain) that starts with the trial. A call at `now` first
// advances to the last grid point not after `now`, so the grid of the calls does not matter: whoever reads at
// 0.37 ms and at 1 ms gets the bits of whoever reads at 1 ms. A command or percept at the instant of a brain tick counts in that tick.
#pragma once

#include <optional>

#include "master/devices/software_handle.hpp"
#include "master/operator/virtual_operator.hpp"

namespace thimble {

class SimulatedHandle final : public SoftwareHandle {
  public:
    SimulatedHandle(const HandleSettings& settings, const OperatorParameters& parameters);

    void start_trial(SessionTime now, const OperatorTask& task) override;
    // Each percept replaces the last one whole; touch and beep are remembered.
    void perceive(SessionTime now, const Percept& percept) override;
    bool finished() const override;

    double position_hand_m() const override { return limb_.position_hand_m(); }
    // Milliseconds left out because no call came for longer than a second.
    std::uint64_t skipped_ms() const { return skipped_ms_; }
    // Null before the first trial.
    const VirtualOperator* operator_in_trial() const { return operator_ ? &*operator_ : nullptr; }

  private:
    void advance(SessionTime now) override;

    OperatorParameters parameters_;
    Limb limb_;
    std::optional<VirtualOperator> operator_;
    Percept percept_;
    SessionTime reached_{};  // grid point
    unsigned substep_ = 0;   // of the millisecond under way
    std::uint64_t skipped_ms_ = 0;
};

}  // namespace thimble
