#include "master/force_guard.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace thimble {
namespace {

constexpr std::size_t kLongestWords = 200;
constexpr double kNothingYet_J = -std::numeric_limits<double>::infinity();

}  // namespace

GuardSettings read_guard_settings(const ConfigTable& table) {
    using std::chrono::milliseconds;
    using std::chrono::seconds;
    GuardSettings s;
    s.force_limit_N = table.number("force_limit_N", s.force_limit_N, 0, 1000);
    s.force_rate_limit_N_per_s = table.number("force_rate_limit_N_per_s", s.force_rate_limit_N_per_s, 0, 1e6);
    s.energy_limit_J = table.number("energy_limit_J", s.energy_limit_J, 0, 1000);
    s.energy_window = table.seconds("energy_window_s", s.energy_window, milliseconds{10}, seconds{60});
    if (table.has("energy_window_s") && s.energy_limit_J == 0) {
        table.fail("energy_window_s", "has no meaning without energy_limit_J, e.g. energy_limit_J = 0.2");
    }
    return s;
}

ForceGuard::ForceGuard(const GuardSettings& settings, Duration sample_period)
    : settings_(settings), sample_period_(sample_period) {
    clear({});
}

void ForceGuard::clear(SessionTime now) {
    words_.clear();
    words_.reserve(kLongestWords);
    energy_.clear();
    highest_J_.fill(kNothingYet_J);
    slot_ = 0;
    slot_end_ = now + settings_.energy_window / static_cast<std::int64_t>(kSlots);
    given_at_ = now;
    given_N_ = 0;
    most_given_out_J_ = 0;
}

void ForceGuard::observe(SessionTime now, const HandleSample& sample) {
    if (!sample.valid || tripped()) return;
    if (!std::isfinite(sample.position_hand_m) || !std::isfinite(sample.force_hand_N)) {
        return trip("the handle's own measurement is no number");
    }
    energy_.add(sample);
    watch_energy(now);
}

// The window moves on by whole parts: it is at most a 64th longer than asked, so that it trips rather too early.
void ForceGuard::watch_energy(SessionTime now) {
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
    std::array<char, kLongestWords> words{};
    const auto end =
        fmt::format_to_n(words.data(), words.size() - 1,
                         "the handle gave {:.3g} J to the hand within {:g} s; [guard] "
                         "energy_limit_J is {:g}",
                         given_out_J, to_seconds(settings_.energy_window), settings_.energy_limit_J);
    trip({words.data(), static_cast<std::size_t>(end.out - words.data())});
}

double ForceGuard::pass(SessionTime now, double wanted_N) {
    if (!std::isfinite(wanted_N)) trip("a force was asked of the handle that is no number");
    if (tripped()) {
        given_N_ = 0;
        given_at_ = now;
        return 0;
    }
    double force_N = std::clamp(wanted_N, -settings_.force_limit_N, settings_.force_limit_N);
    if (settings_.force_rate_limit_N_per_s > 0) force_N = limited_rate(now, force_N);
    if (force_N != wanted_N) ++cut_;
    given_N_ = force_N;
    given_at_ = std::max(given_at_, now);
    return force_N;
}

// From one sign to the other it starts at zero.
double ForceGuard::limited_rate(SessionTime now, double force_N) const {
    const double before_N = given_N_ * force_N > 0 ? std::abs(given_N_) : 0;
    const double elapsed_s = to_seconds(std::clamp(now - given_at_, Duration{}, sample_period_));
    const double most_N = before_N + settings_.force_rate_limit_N_per_s * elapsed_s;
    return std::copysign(std::min(std::abs(force_N), most_N), force_N);
}

void ForceGuard::trip(std::string_view words) {
    if (!tripped()) words_.assign(words);
}

}  // namespace thimble
