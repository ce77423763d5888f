#include "stability/perceptual_loop.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "common/error.hpp"
#include "common/math/portable.hpp"
#include "slave_sim/second_order.hpp"
#include "stability/loop_measures.hpp"

namespace thimble {
namespace {

constexpr double kLet_go_m = 1e-3;
constexpr double kLongestLedStep_s = 1e-3;
constexpr double kWatchedLags = 80, kWatchedPeriods = 60;

void require_positive(double value, const char* what) {
    if (std::isfinite(value) && value > 0) return;
    throw Error(ExitCode::kUsage, std::string(what) + " must be finite and above 0");
}

void require(const PausedCorrection& correction) {
    require_positive(correction.lag_s, "stability: the lag (--perception-lag-s)");
    require_positive(correction.period_s, "stability: the period of a correction");
    require_positive(correction.move_s, "stability: the duration of a move");
    if (correction.move_s > correction.period_s)
        throw Error(ExitCode::kUsage, "stability: a move must end before the next one begins");
}

// The hand on its spring, whose rest position the person moves. Past positions are kept.
class GuidedHand {
  public:
    GuidedHand(const HeldMass& hand, double lag_s)
        : stiffness_N_per_m_(hand.stiffness_N_per_m),
          lag_steps_(static_cast<std::size_t>(std::ceil(lag_s / kLongestLedStep_s))),
          step_s_(lag_s / static_cast<double>(lag_steps_)),
          motion_(hand.mass_kg, hand.damping_Ns_per_m, hand.stiffness_N_per_m),
          propagator_(motion_.propagator(step_s_)),
          were_m_(lag_steps_ + 1, kLet_go_m) {}

    double step_s() const { return step_s_; }
    double position_m() const { return position_m_; }
    // As it was one lag before the middle of the coming step.
    double perceived_m() const { return (were_m_[oldest_] + were_m_[(oldest_ + 1) % were_m_.size()]) / 2; }
    // One step, in which the reference moves by `moved_m`.
    void step(double moved_m) {
        const double pull_N = stiffness_N_per_m_ * (reference_m_ + moved_m / 2);
        const double a = motion_.acceleration(pull_N, position_m_, velocity_m_per_s_);
        const double travel_m = propagator_.moved_m(velocity_m_per_s_, a);
        velocity_m_per_s_ = propagator_.velocity_after_m_per_s(velocity_m_per_s_, a);
        position_m_ += travel_m;
        reference_m_ += moved_m;
        were_m_[oldest_] = position_m_;
        oldest_ = (oldest_ + 1) % were_m_.size();
    }

  private:
    double stiffness_N_per_m_;
    std::size_t lag_steps_;
    double step_s_;
    SecondOrder motion_;
    Propagator propagator_;
    std::vector<double> were_m_;
    std::size_t oldest_ = 0;
    double position_m_ = kLet_go_m, velocity_m_per_s_ = 0, reference_m_ = kLet_go_m;
};

// Doubles the gain until the loop grows, then halves the interval.
double limit_of(const std::function<double(double)>& growth, double start, double relative) {
    double stable = 0, unstable = start;
    for (int i = 0; i < 60 && growth(unstable) <= 0; ++i) {
        stable = unstable;
        unstable *= 2;
    }
    while (unstable - stable > relative * unstable) {
        const double middle = (stable + unstable) / 2;
        (growth(middle) > 0 ? unstable : stable) = middle;
    }
    return (stable + unstable) / 2;
}

// Minimum jerk, part of the way at u of the time (Flash and Hogan 1985).
double minimum_jerk(double u) {
    u = std::clamp(u, 0.0, 1.0);
    return u * u * u * (10 + u * (6 * u - 15));
}

// Logarithm of the greatest position in the last quarter over that in the second quarter.
double paused_growth(const HeldMass& hand, const PausedCorrection& correction, double part) {
    GuidedHand led(hand, correction.lag_s);
    const double lasts_s = kWatchedPeriods * std::max(correction.period_s, correction.lag_s);
    const auto steps = static_cast<std::size_t>(lasts_s / led.step_s());
    double early_m = 0, late_m = 0, move_m = 0, began_s = -1;
    for (std::size_t i = 0; i < steps; ++i) {
        const double now_s = static_cast<double>(i) * led.step_s();
        if (began_s < 0 || now_s >= began_s + correction.period_s) {
            began_s = began_s < 0 ? 0 : began_s + correction.period_s;
            move_m = -part * led.perceived_m();
        }
        const double from = (now_s - began_s) / correction.move_s;
        led.step(move_m * (minimum_jerk(from + led.step_s() / correction.move_s) - minimum_jerk(from)));
        const std::size_t quarter = 4 * i / steps;
        if (quarter == 1) early_m = std::max(early_m, std::abs(led.position_m()));
        if (quarter == 3) late_m = std::max(late_m, std::abs(led.position_m()));
        if (std::abs(led.position_m()) > 1e6 * kLet_go_m) return 1;
    }
    // A swing that has died out cannot be compared.
    return late_m < 1e-12 * kLet_go_m ? -1 : portable::log(late_m / early_m);
}

}  // namespace

double paused_limit(const PausedCorrection& correction) {
    require(correction);
    // A sum that equals a period up to rounding counts as a period.
    const double periods = (correction.lag_s + correction.move_s) / correction.period_s;
    const double old = std::max(0.0, std::ceil(periods - 1e-9) - 1);
    return 2 * portable::sin(std::numbers::pi / (4 * old + 2));
}

double measured_perceptual_growth_per_s(const HeldMass& hand, double lag_s, double gain_per_s) {
    perceptual_limit(hand, lag_s);  // throws where it is no loop
    require_positive(lag_s, "stability: the lag (--perception-lag-s)");
    GuidedHand led(hand, lag_s);
    const auto steps = static_cast<std::size_t>(kWatchedLags * lag_s / led.step_s());
    std::vector<double> trace;
    trace.reserve(steps);
    for (std::size_t i = 0; i < steps && std::abs(led.position_m()) < 1e6; ++i) {
        trace.push_back(led.position_m());
        led.step(-gain_per_s * led.perceived_m() * led.step_s());
    }
    const std::span<const double> all(trace);
    return portable::log(growth_per_sample(all.subspan(all.size() / 2))) / led.step_s();
}

double measured_perceptual_limit_per_s(const HeldMass& hand, double lag_s, double relative) {
    return limit_of(
        [&](double gain_per_s) { return measured_perceptual_growth_per_s(hand, lag_s, gain_per_s); },
        0.5 / lag_s, relative);
}

double measured_paused_limit(const HeldMass& hand, const PausedCorrection& correction, double relative) {
    require(correction);
    perceptual_limit(hand, correction.lag_s);
    return limit_of([&](double part) { return paused_growth(hand, correction, part); }, 0.1, relative);
}

}  // namespace thimble
