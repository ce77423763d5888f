// The Novint Falcon. Its frame: z from the base towards the user; the needle's axis and the other two are AxisConstraint's.
// Before its legs are homed (the user pulls the grip out and pushes it in, once after each loading of the firmware) it has no
// position and gets no force: awaits() and the fault say so, and go by themselves. Homing that is lost afterwards is a fault.
//
// A report that does not come costs the force within two ticks (FalconExchange), and the trial after kStalledAfter. Then read() reports
// no force, and the force is zero until the next command. So the guard's rate limit holds (GuardedHandle).
#pragma once

#include <memory>

#include "common/runtime/runtime_settings.hpp"
#include "master/devices/falcon/falcon_mailbox.hpp"
#include "master/devices/handle.hpp"
#include "master/devices/handle_settings.hpp"

namespace thimble {

class FalconHandle : public Handle {
  public:
    // No report for so long: the device stands still.
    static constexpr Duration kStalledAfter = std::chrono::milliseconds{20};

    // An exchange serves `mailbox`, which outlives the handle.
    FalconHandle(const FalconSettings& settings, double force_limit_N, std::string name,
                 FalconMailbox& mailbox);
    ~FalconHandle() override;

    HandleSample read(SessionTime now) override;
    // A force that is not a number counts as zero.
    void command_force(SessionTime now, double force_hand_N) override;
    void enable_force(SessionTime now, bool enabled) override;
    std::string_view fault() const override;
    // One of the grip's buttons that the settings name.
    bool take_stop(SessionTime now) override;
    SessionTime next_look() const override { return kNever; }

    std::string name() const override { return name_; }
    std::string awaits() override;
    void describe(nlohmann::ordered_json& report) const override;
    // Forces that were scaled down to the motors' limit.
    std::uint64_t saturated() const { return saturated_; }

  private:
    bool take_report(SessionTime now);
    void apply();
    bool fail(const std::string& what);
    bool fail_lost();

    FalconSettings settings_;
    std::string name_, not_homed_, fault_;
    FalconMailbox* mailbox_;
    AxisConstraint axis_;
    DeviceVector position_m_{0, 0, 0.11};
    bool forced_ = false;
    bool homed_ = false;
    double force_hand_N_ = 0;
    std::uint8_t count_ = 0;
    SessionTime heard_{};
    bool reading_ = false;  // heard_ is of this trial
    std::uint64_t reads_ = 0, silent_reads_ = 0, saturated_ = 0;
};

// Starts the guardian (falcon_guardian.hpp), which finds the device, loads its firmware if it has none, and exchanges packets. It is
// scheduled as `runtime` says. `program`: its executable, by default this one. Throws Error with what is missing and what to do.
std::unique_ptr<Handle> open_falcon(const FalconSettings& settings, double force_limit_N,
                                    const RuntimeSettings& runtime,
                                    const std::string& program = "/proc/self/exe");

}  // namespace thimble
