#include "stability/delayed_loop.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "common/error.hpp"
#include "stability/root_count.hpp"

namespace thimble {
namespace {

constexpr double kNever_s = std::numeric_limits<double>::infinity();
constexpr double kLongestDelay_s = 1e6;
constexpr double kMostTurned_rad = 1e8;  // a larger count of roots has no use, and would not fit

void require(bool good, const char* what, double value) {
    if (good) return;
    throw Error(ExitCode::kUsage, "stability: {}, not {:g}", what, value);
}

bool not_negative(double value) { return std::isfinite(value) && value >= 0; }

std::vector<PreciseFamily> families_of(const DelayedLoop& loop) {
    require_meaningful(loop);
    return precise_families(ShiftedLoop::by(loop, 0, 0));
}

// Walks through the crossings of all families in order of delay.
class InOrder {
  public:
    explicit InOrder(std::vector<PreciseFamily> families) : families_(std::move(families)) {
        next_.reserve(families_.size());
        for (const PreciseFamily& family : families_) next_.push_back(family.first_delay);
    }
    bool empty() const { return families_.empty(); }
    RootCrossing take() {
        const auto least =
            static_cast<std::size_t>(std::min_element(next_.begin(), next_.end()) - next_.begin());
        const PreciseFamily& family = families_[least];
        roots_ += 2 * family.direction;
        const RootCrossing crossing{to_double(next_[least]), to_double(family.frequency), family.direction,
                                    roots_};
        next_[least] = family.first_delay + 2 * pi_of<Precise>() * ++turns_[least] / family.frequency;
        return crossing;
    }

  private:
    std::vector<PreciseFamily> families_;
    std::vector<Precise> next_;
    std::array<int, 2> turns_{};
    int roots_ = 0;
};

}  // namespace

void require_meaningful(const HeldMass& held) {
    require(std::isfinite(held.mass_kg) && held.mass_kg > 0, "the mass must be above 0 kg", held.mass_kg);
    require(not_negative(held.damping_Ns_per_m), "damping must be 0 Ns/m or more", held.damping_Ns_per_m);
    require(not_negative(held.stiffness_N_per_m), "the hand's stiffness must be 0 N/m or more",
            held.stiffness_N_per_m);
}

void require_meaningful(const DelayedLoop& loop) {
    require_meaningful(loop.hand);
    require(std::isfinite(loop.stiffness_N_per_m) && loop.stiffness_N_per_m > 0,
            "the contact's stiffness must be above 0 N/m", loop.stiffness_N_per_m);
    require(not_negative(loop.delayed_damping_Ns_per_m), "delayed damping must be 0 Ns/m or more",
            loop.delayed_damping_Ns_per_m);
}

void require_delay(double delay_s) {
    require(not_negative(delay_s) && delay_s <= kLongestDelay_s, "a delay must be 0 to 1e6 s", delay_s);
}

void require_countable(const DelayedLoop& loop, double delay_s) {
    require_meaningful(loop);
    require_delay(delay_s);
    double angle = 0;
    for (const PreciseFamily& f : families_of(loop)) angle += delay_s * to_double(f.frequency);
    require(angle < kMostTurned_rad,
            "the product of delay and frequency must stay below 1e8 rad: give a shorter delay", angle);
}

std::vector<RootCrossing> crossings(const DelayedLoop& loop, double longest_s, std::size_t most) {
    InOrder order(families_of(loop));
    std::vector<RootCrossing> all;
    while (!order.empty() && all.size() < most) {
        const RootCrossing crossing = order.take();
        if (!(crossing.delay_s <= longest_s)) break;
        all.push_back(crossing);
    }
    return all;
}

int unstable_roots(const DelayedLoop& loop, double delay_s) {
    require_countable(loop, delay_s);
    return static_cast<int>(roots_right_of(ShiftedLoop::by(loop, delay_s, 0), delay_s));
}

std::vector<StableDelays> stable_delays(const DelayedLoop& loop, std::size_t most) {
    InOrder order(families_of(loop));
    if (order.empty()) return {{0, kNever_s}};
    std::vector<StableDelays> windows;
    // The upper frequency crosses more often, so that after a while no gap is left: two crossings outward in a row.
    double from_s = 0;
    int roots = 0;
    while (windows.size() < most) {
        const RootCrossing crossing = order.take();
        if (roots == 0 && crossing.delay_s > from_s) windows.push_back({from_s, crossing.delay_s});
        const bool rises_for_good = crossing.unstable_roots_after >= 4;
        roots = crossing.unstable_roots_after;
        from_s = crossing.delay_s;
        if (rises_for_good) break;
    }
    return windows;
}

CriticalPoint critical_point(const DelayedLoop& loop) {
    CriticalPoint first{kNever_s, 0};
    for (const PreciseFamily& f : families_of(loop)) {
        if (f.direction > 0) first = {to_double(f.first_delay), to_double(f.frequency)};
    }
    return first;
}

double delay_independent_stiffness_N_per_m(const HeldMass& held) {
    require_meaningful(held);
    const Precise m(held.mass_kg), b(held.damping_Ns_per_m), k(held.stiffness_N_per_m);
    if (b * b >= 2 * m * k) return held.stiffness_N_per_m;
    return to_double(b * sqrt(Precise(4 * m * k - b * b)) / (2 * m));
}

}  // namespace thimble
