// A handle in software: an encoder that rounds to the nearest count, and a limit of its force. No motors to switch off, no button,
// and nothing that fails.
#pragma once

#include <algorithm>
#include <cmath>

#include "master/devices/handle.hpp"
#include "master/devices/handle_settings.hpp"

namespace thimble {

class SoftwareHandle : public Handle {
  public:
    explicit SoftwareHandle(const HandleSettings& settings)
        : settings_(settings), counts_per_m_(1 / settings.encoder_resolution_m) {}

    HandleSample read(SessionTime now) override {
        advance(now);
        const double counts = position_hand_m() * counts_per_m_;
        const auto nearest = static_cast<std::int64_t>(counts + (counts < 0 ? -0.5 : 0.5));
        return {static_cast<double>(nearest) * settings_.encoder_resolution_m, force_hand_N_};
    }
    // A force that is not a number counts as zero.
    void command_force(SessionTime now, double force_hand_N) override {
        advance(now);
        if (!std::isfinite(force_hand_N)) {
            ++refused_forces_;
            force_hand_N = 0;
        }
        force_hand_N_ = std::clamp(force_hand_N, -settings_.force_limit_N, settings_.force_limit_N);
    }
    void enable_force(SessionTime /*now*/, bool /*enabled*/) override {}
    bool take_stop(SessionTime /*now*/) override { return false; }
    SessionTime next_look() const override { return kNever; }
    std::string_view fault() const override { return {}; }

    // Values that no real device has: of the last grid point that was reached, before the encoder.
    virtual double position_hand_m() const = 0;
    double force_hand_N() const { return force_hand_N_; }
    std::uint64_t refused_forces() const { return refused_forces_; }

  protected:
    // Advances to the last point of its own time grid not after `now`.
    virtual void advance(SessionTime now) = 0;

    HandleSettings settings_;
    double force_hand_N_ = 0;

  private:
    double counts_per_m_;
    std::uint64_t refused_forces_ = 0;
};

}  // namespace thimble
