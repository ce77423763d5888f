// The last stage before the handle: the rules of ForceGuard, and two that need the handle's own measurements. A measurement that
// is no number trips the guard. So does a handle that gives out more than energy_limit_J to the hand since any moment of the last
// energy_window (passivity observer, Hannaford and Ryu 2002; PortObserver).
// Forces are positive where they push the hand out (-z), as at HapticDevice.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "common/config.hpp"
#include "common/control/port_observer.hpp"
#include "common/force_guard.hpp"
#include "common/shared_values.hpp"
#include "master/devices/haptic_device.hpp"

namespace thimble {

inline constexpr double kNothingYet_J = -std::numeric_limits<double>::infinity();

struct GuardSettings {
    double force_limit_N = kHandleFullScale_N;
    double force_rate_limit_N_per_s = 0;  // 0: none
    double energy_limit_J = 0;            // 0: none
    Duration energy_window = std::chrono::seconds{1};
};

// Where a session file says nothing else, of a handle whose motors push a person's hand. docs/safety.md names the sources.
//
// - Rate: the paper's fixture at the handle, 9 kN/m, met at 0.25 m/s. ISO 10218 allows a robot this speed beside a person.
//
// - Energy: of a robot's contact with hands or fingers (ISO/TS 15066), F^2 / 2k = 0.52 J, with 2 x 140 N and 75 N/mm.
inline GuardSettings guard_of_real_handle() {
    GuardSettings s;
    s.force_rate_limit_N_per_s = 9000 * 0.25;
    s.energy_limit_J = 0.5;
    return s;
}

// Table [guard], over the values of `s`; throws Error (usage).
inline GuardSettings read_guard_settings(const ConfigTable& table, GuardSettings s = {}) {
    table.read("force_limit_N", s.force_limit_N, 0, 1000,
               "Force limit of the guard before the handle; at least [master] force_limit_N.");
    table.read("force_rate_limit_N_per_s", s.force_rate_limit_N_per_s, 0, 1e6,
               "Limit of the force's rate of growth; 0: none. For a real handle the default is 2250.");
    table.read("energy_limit_J", s.energy_limit_J, 0, 1000,
               "Limit of the energy given to the hand within the window; more stops everything; 0: none. For "
               "a real handle the default is 0.5.");
    table.read("energy_window_s", s.energy_window, 0.01, 60, "Time window of energy_limit_J.");
    if (table.has("energy_window_s") && s.energy_limit_J == 0) {
        table.fail("energy_window_s", "has an effect with energy_limit_J only, e.g. energy_limit_J = 0.2");
    }
    return s;
}

class GuardedHandle final : public HapticDevice {
  public:
    // sample_period: of the handle. `device` outlives the guard.
    GuardedHandle(const GuardSettings& settings, Duration sample_period, HapticDevice& device)
        : settings_(settings),
          device_(&device),
          rules_({-settings.force_limit_N, settings.force_limit_N, settings.force_rate_limit_N_per_s,
                  sample_period},
                 "the handle") {
        clear({});
    }

    // A trial begins: no force, no energy counted yet, not tripped.
    void clear(SessionTime now) {
        rules_.clear(now);
        energy_.clear();
        highest_J_.fill(kNothingYet_J);
        before_J_ = kNothingYet_J;
        slot_ = 0;
        slot_end_ = now + part();
        most_given_out_J_ = 0;
    }

    bool tripped() const { return rules_.tripped(); }
    std::string_view text() const { return rules_.text(); }
    std::uint64_t cut() const { return rules_.cut(); }
    // The most that the handle has given out within the window in this trial, J.
    double most_given_out_J() const { return most_given_out_J_; }
    // Work of the hand on the handle in this trial. Below 0 the handle has given out more than it got: it is not passive.
    const PortObserver& energy() const { return energy_; }

    // Each sample of a trial counts for the energy.
    HandleSample read(SessionTime now) override {
        const HandleSample sample = device_->read(now);
        if (!sample.valid) rules_.device_gives(0);  // a device that has failed gives no force
        if (!sample.valid || tripped()) return sample;
        if (std::isfinite(sample.position_hand_m) && std::isfinite(sample.force_hand_N)) {
            rules_.device_gives(sample.force_hand_N);
            energy_.add(sample.position_hand_m, sample.force_hand_N);
            watch_energy(now);
        } else {
            rules_.trip("the handle reports a value that is not a number");
        }
        return sample;
    }

    void command_force(SessionTime now, double force_hand_N) override {
        device_->command_force(now, rules_.pass(now, force_hand_N));
    }
    void enable_force(SessionTime now, bool enabled) override { device_->enable_force(now, enabled); }
    bool take_stop(SessionTime now) override { return device_->take_stop(now); }
    SessionTime next_look() const override { return device_->next_look(); }
    std::string_view fault() const override { return device_->fault(); }

  private:
    static constexpr std::size_t kSlots = 64;

    // The newest part is not full, so the other 63 are the window.
    Duration part() const {
        return std::max(settings_.energy_window / static_cast<std::int64_t>(kSlots - 1), Duration{1});
    }

    // The window moves by whole parts. So it is up to 1/63 longer than asked, which trips earlier.
    void watch_energy(SessionTime now) {
        if (now - slot_end_ > 2 * settings_.energy_window) {
            highest_J_.fill(kNothingYet_J);
            before_J_ = kNothingYet_J;
            slot_end_ = now + part();
        }
        for (; now >= slot_end_; slot_end_ += part()) begin_part();
        const double energy_J = energy_.energy_in_J();
        highest_J_[slot_] = std::max(highest_J_[slot_], energy_J);
        const double given_out_J = std::max(before_J_, highest_J_[slot_]) - energy_J;
        most_given_out_J_ = std::max(most_given_out_J_, given_out_J);
        if (settings_.energy_limit_J <= 0 || given_out_J <= settings_.energy_limit_J) return;
        std::array<char, ForceGuard::kLongestText> text{};
        const auto end = fmt::format_to_n(
            text.data(), text.size() - 1,
            "the handle gave {:.3g} J to the hand within {:g} s; the limit is [guard] energy_limit_J = {:g}",
            given_out_J, to_seconds(settings_.energy_window), settings_.energy_limit_J);
        rules_.trip({text.data(), static_cast<std::size_t>(end.out - text.data())});
    }

    // Looks at all parts only when the highest one leaves the window.
    void begin_part() {
        before_J_ = std::max(before_J_, highest_J_[slot_]);
        slot_ = (slot_ + 1) % kSlots;
        const double leaves_J = std::exchange(highest_J_[slot_], kNothingYet_J);
        if (leaves_J >= before_J_) before_J_ = *std::max_element(highest_J_.begin(), highest_J_.end());
    }

    GuardSettings settings_;
    HapticDevice* device_;
    ForceGuard rules_;
    PortObserver energy_;
    std::array<double, kSlots> highest_J_{};  // energy taken in, its highest within each part of the window
    double before_J_ = kNothingYet_J;         // the highest of the other parts
    std::size_t slot_ = 0;
    SessionTime slot_end_{};
    double most_given_out_J_ = 0;
};

}  // namespace thimble
