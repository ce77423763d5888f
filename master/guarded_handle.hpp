// The last stage before the handle: the rules of ForceGuard, and two that need the handle's own measurements. A measurement that
// is no number trips the guard. So does a handle that gives out more than energy_limit_J to the hand since any moment of the last
// energy_window (passivity observer, Hannaford and Ryu 2002; PortObserver).
// Forces are positive where they push the hand out (-z), as at HapticDevice.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "common/config.hpp"
#include "common/control/port_observer.hpp"
#include "common/force_guard.hpp"
#include "common/shared_values.hpp"
#include "master/devices/haptic_device.hpp"

namespace thimble {

struct GuardSettings {
    double force_limit_N = kHandleFullScale_N;
    double force_rate_limit_N_per_s = 0;  // 0: none
    double energy_limit_J = 0;            // 0: none
    Duration energy_window = std::chrono::seconds{1};
};

// Table [guard]; throws Error (usage).
GuardSettings read_guard_settings(const ConfigTable& table);

class GuardedHandle final : public HapticDevice {
  public:
    // sample_period: of the handle. `device` outlives the guard.
    GuardedHandle(const GuardSettings& settings, Duration sample_period, HapticDevice& device);

    // A trial begins: no force, no energy counted yet, not tripped.
    void clear(SessionTime now);
    bool tripped() const { return rules_.tripped(); }
    std::string_view text() const { return rules_.text(); }
    std::uint64_t cut() const { return rules_.cut(); }
    // The most that the handle has given out within the window in this trial, J.
    double most_given_out_J() const { return most_given_out_J_; }
    // Work of the hand on the handle in this trial. Below 0 the handle has given out more than it got: it is not passive.
    const PortObserver& energy() const { return energy_; }

    // Each sample of a trial counts for the energy.
    HandleSample read(SessionTime now) override;
    void command_force(SessionTime now, double force_hand_N) override {
        device_->command_force(now, rules_.pass(now, force_hand_N));
    }
    void enable_force(SessionTime now, bool enabled) override { device_->enable_force(now, enabled); }
    bool take_stop(SessionTime now) override { return device_->take_stop(now); }
    SessionTime next_look() const override { return device_->next_look(); }
    std::string_view fault() const override { return device_->fault(); }

  private:
    static constexpr std::size_t kSlots = 64;  // of the window

    void watch_energy(SessionTime now);

    GuardSettings settings_;
    HapticDevice* device_;
    ForceGuard rules_;
    PortObserver energy_;
    std::array<double, kSlots> highest_J_{};  // energy taken in, its highest within each part of the window
    std::size_t slot_ = 0;
    SessionTime slot_end_{};
    double most_given_out_J_ = 0;
};

}  // namespace thimble
