#include "master/guarded_handle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace thimble {
namespace {

constexpr double kNothingYet_J = -std::numeric_limits<double>::infinity();

}  // namespace

GuardSettings read_guard_settings(const ConfigTable& table) {
    GuardSettings s;
    table.read("force_limit_N", s.force_limit_N, 0, 1000,
               "No more leaves for the handle, whoever asks; [master] force_limit_N may not be larger.");
    table.read("force_rate_limit_N_per_s", s.force_rate_limit_N_per_s, 0, 1e6,
               "A force grows no faster; 0: as fast as it likes.");
    table.read("energy_limit_J", s.energy_limit_J, 0, 1000,
               "More given out to the hand within the window stops everything; 0: never.");
    table.read("energy_window_s", s.energy_window, 0.01, 60, "With energy_limit_J.");
    if (table.has("energy_window_s") && s.energy_limit_J == 0) {
        table.fail("energy_window_s", "has no meaning without energy_limit_J, e.g. energy_limit_J = 0.2");
    }
    return s;
}

GuardedHandle::GuardedHandle(const GuardSettings& settings, Duration sample_period, HapticDevice& device)
    : settings_(settings),
      device_(&device),
      rules_(
          {-settings.force_limit_N, settings.force_limit_N, settings.force_rate_limit_N_per_s, sample_period},
          "the handle") {
    clear({});
}

void GuardedHandle::clear(SessionTime now) {
    rules_.clear(now);
    energy_.clear();
    highest_J_.fill(kNothingYet_J);
    slot_ = 0;
    slot_end_ = now + settings_.energy_window / static_cast<std::int64_t>(kSlots);
    most_given_out_J_ = 0;
}

HandleSample GuardedHandle::read(SessionTime now) {
    const HandleSample sample = device_->read(now);
    if (!sample.valid || tripped()) return sample;
    if (std::isfinite(sample.position_hand_m) && std::isfinite(sample.force_hand_N)) {
        energy_.add(sample.position_hand_m, sample.force_hand_N);
        watch_energy(now);
    } else {
        rules_.trip("the handle's own measurement is no number");
    }
    return sample;
}

// The window moves on by whole parts: it is at most a 64th longer than asked, so that it trips rather too early.
void GuardedHandle::watch_energy(SessionTime now) {
    const Duration part = std::max(settings_.energy_window / static_cast<std::int64_t>(kSlots), Duration{1});
    if (now - slot_end_ > 2 * settings_.energy_window) {
        highest_J_.fill(kNothingYet_J);
        slot_end_ = now + part;
    }
    for (; now >= slot_end_; slot_end_ += part) {
        slot_ = (slot_ + 1) % kSlots;
        highest_J_[slot_] = kNothingYet_J;
    }
    const double energy_J = energy_.energy_in_J();
    highest_J_[slot_] = std::max(highest_J_[slot_], energy_J);
    const double given_out_J = *std::max_element(highest_J_.begin(), highest_J_.end()) - energy_J;
    most_given_out_J_ = std::max(most_given_out_J_, given_out_J);
    if (settings_.energy_limit_J <= 0 || given_out_J <= settings_.energy_limit_J) return;
    std::array<char, ForceGuard::kLongestText> text{};
    const auto end =
        fmt::format_to_n(text.data(), text.size() - 1,
                         "the handle gave {:.3g} J to the hand within {:g} s; [guard] "
                         "energy_limit_J is {:g}",
                         given_out_J, to_seconds(settings_.energy_window), settings_.energy_limit_J);
    rules_.trip({text.data(), static_cast<std::size_t>(end.out - text.data())});
}

}  // namespace thimble
