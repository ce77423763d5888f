// The last stage before the handle. It knows the force that somebody wants and what the handle says of itself, and nothing
// else: no message, no network, no session, so that no input from outside can talk it round.
//
// What it gives out is never larger than what was asked, never of the other sign, never beyond force_limit_N, and never grows
// faster than force_rate_limit_N_per_s, where the time since the force before counts as one sample period at most. So neither
// a silence nor a new trial allows a jump. Falling, and falling to zero, it may as fast as it likes. It trips, that is gives
// out zero from then on until clear(), when
//   - a force, or what the handle measures, is no number;
//   - the handle has given out more than energy_limit_J to the hand since any moment of the last energy_window (passivity
//     observer, Hannaford and Ryu 2002; PortEnergy).
// Forces are positive where they push the hand out (-z), as at HapticDevice.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "common/config.hpp"
#include "common/shared_values.hpp"
#include "common/time.hpp"
#include "master/devices/haptic_device.hpp"
#include "master/port_energy.hpp"

namespace thimble {

struct GuardSettings {
    double force_limit_N = kHandleFullScale_N;
    double force_rate_limit_N_per_s = 0;  // 0: none
    double energy_limit_J = 0;            // 0: none
    Duration energy_window = std::chrono::seconds{1};
};

// Table [guard]; throws Error (usage).
GuardSettings read_guard_settings(const ConfigTable& table);

class ForceGuard {
  public:
    // sample_period: of the handle.
    ForceGuard(const GuardSettings& settings, Duration sample_period);

    // A trial begins: no force, no energy counted yet, not tripped.
    void clear(SessionTime now);
    // The handle's measurement; call it for each sample of a trial, in order.
    void observe(SessionTime now, const HandleSample& sample);
    // The allowed force for `wanted_N`.
    double pass(SessionTime now, double wanted_N);

    bool tripped() const { return !words_.empty(); }
    // Why, with the numbers; empty while it has not tripped.
    std::string_view words() const { return words_; }
    // Since start: commands that were cut at the limit or by the rate.
    std::uint64_t cut() const { return cut_; }
    // The most that the handle has given out within the window in this trial, J.
    double most_given_out_J() const { return most_given_out_J_; }

  private:
    static constexpr std::size_t kSlots = 64;  // of the window

    void trip(std::string_view words);
    void watch_energy(SessionTime now);
    double limited_rate(SessionTime now, double force_N) const;

    GuardSettings settings_;
    Duration sample_period_;
    PortEnergy energy_;
    std::array<double, kSlots> highest_J_{};  // energy taken in, its highest within each part of the window
    std::size_t slot_ = 0;
    SessionTime slot_end_{};
    SessionTime given_at_{};
    double given_N_ = 0;
    double most_given_out_J_ = 0;
    std::uint64_t cut_ = 0;
    std::string words_;  // with room from the start: nothing is allocated when it trips
};

}  // namespace thimble
