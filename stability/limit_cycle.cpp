#include "stability/limit_cycle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/error.hpp"
#include "common/math/portable.hpp"

namespace thimble {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kBisections = 100;

void require_press(const PressedLoop& loop) {
    require_meaningful(DelayedLoop{loop.hand, loop.stiffness_N_per_m, 0});
    require_delay(loop.delay_s);
    if (loop.hand.stiffness_N_per_m > 0 && loop.force_limit_N > 0 && std::isfinite(loop.force_limit_N) &&
        std::isfinite(loop.press_N)) {
        return;
    }
    throw Error(
        ExitCode::kUsage,
        "stability: a limit cycle needs a hand with stiffness, a force limit above 0 N and a finite press");
}

template <class Function>
double zero_between(double low, double high, const Function& rising) {
    for (int i = 0; i < kBisections; ++i) {
        const double middle = low + (high - low) / 2;
        (rising(middle) > 0 ? high : low) = middle;
    }
    return low + (high - low) / 2;
}

// Of a ramp that begins at u: the part of a unit sine's first harmonic, and its mean.
double ramp_gain(double u) {
    const double c = std::clamp(u, -1.0, 1.0);
    return (portable::acos(c) - c * std::sqrt(1 - c * c)) / kPi;
}
double ramp_mean(double u) {
    if (u <= -1) return -u;
    return u >= 1 ? 0 : (std::sqrt(1 - u * u) - u * portable::acos(u)) / kPi;
}

struct SaturatedContact {
    double stiffness, strip_m;  // K, p_s

    double gain(double mean_m, double swing_m) const {
        return stiffness * (ramp_gain(-mean_m / swing_m) - ramp_gain((strip_m - mean_m) / swing_m));
    }
    double mean_N(double mean_m, double swing_m) const {
        return stiffness * swing_m * (ramp_mean(-mean_m / swing_m) - ramp_mean((strip_m - mean_m) / swing_m));
    }
};

// The mean p at which mean force and spring balance the press; both rise with p.
double mean_at(const PressedLoop& loop, const SaturatedContact& contact, double swing_m) {
    const double k = loop.hand.stiffness_N_per_m;
    return zero_between((loop.press_N - loop.force_limit_N) / k, loop.press_N / k,
                        [&](double p) { return contact.mean_N(p, swing_m) + k * p - loop.press_N; });
}

double rest_position_m(const PressedLoop& loop) {
    const double k = loop.hand.stiffness_N_per_m, K = loop.stiffness_N_per_m;
    if (loop.press_N <= 0) return loop.press_N / k;
    const double inside_m = loop.press_N / (K + k);
    return inside_m * K <= loop.force_limit_N ? inside_m : (loop.press_N - loop.force_limit_N) / k;
}

// `next(press)` says whether the cycle can be followed to this press, and remembers it; each success is a step on. The last press.
template <class Follow>
double followed_N(double from_N, double first_step_N, const Follow& next) {
    constexpr double kFinest = 1e-4;  // of the first step
    double at_N = from_N;
    for (double step_N = first_step_N; step_N > kFinest * first_step_N;) {
        if (next(at_N + step_N)) {
            at_N += step_N;
        } else {
            step_N /= 2;
        }
        if (at_N > 100 * from_N) return std::numeric_limits<double>::infinity();
    }
    return at_N;
}

double relay_fold_N(PressedLoop loop, LimitCycle cycle) {
    const double k = loop.hand.stiffness_N_per_m;
    return followed_N(loop.press_N, loop.force_limit_N / 16, [&](double press_N) {
        loop.press_N = press_N;
        LimitCycle guess = cycle;
        guess.mean_m = (press_N - cycle.duty * loop.force_limit_N) / k;
        const auto found = relay_orbit(loop, guess);
        if (!found) return false;
        cycle = *found;
        return true;
    });
}

double harmonic_fold_N(PressedLoop loop) {
    return followed_N(loop.press_N, loop.force_limit_N / 16, [&](double press_N) {
        loop.press_N = press_N;
        return describing_function_cycle(loop).has_value();
    });
}

}  // namespace

// From the greatest amplitude that a relay of F_s could keep up downwards, the first at which the equivalent gain is K*.
std::optional<LimitCycle> describing_function_cycle(const PressedLoop& loop) {
    require_press(loop);
    const CriticalStiffness critical = critical_stiffness(loop.hand, loop.delay_s);
    if (!(critical.stiffness_N_per_m > 0) || critical.stiffness_N_per_m >= loop.stiffness_N_per_m)
        return std::nullopt;
    const SaturatedContact contact{loop.stiffness_N_per_m, loop.force_limit_N / loop.stiffness_N_per_m};
    const auto lacks_gain = [&](double swing_m) {
        return critical.stiffness_N_per_m - contact.gain(mean_at(loop, contact, swing_m), swing_m);
    };
    constexpr double kRatio = 1.02;
    constexpr int kSteps = 1200;  // ten decades
    double high = 2 * loop.force_limit_N / (kPi * critical.stiffness_N_per_m) * kRatio;
    for (int i = 0; i < kSteps; ++i, high /= kRatio) {
        if (lacks_gain(high / kRatio) > 0) continue;
        const double A = zero_between(high / kRatio, high, lacks_gain);
        const double mean = mean_at(loop, contact, A);
        return LimitCycle{critical.frequency_rad_per_s, A, mean, mean - A, mean + A, 0};
    }
    return std::nullopt;
}

PressForecast forecast_press(const PressedLoop& loop) {
    require_press(loop);
    const double k = loop.hand.stiffness_N_per_m, K = loop.stiffness_N_per_m;
    PressForecast forecast;
    forecast.rest_m = rest_position_m(loop);
    forecast.pushed_through = loop.press_N > loop.force_limit_N * (1 + k / K);
    const bool in_strip = loop.press_N > 0 && !forecast.pushed_through;
    forecast.rest_is_stable =
        loop.hand.damping_Ns_per_m > 0 && (!in_strip || unstable_roots({loop.hand, K, 0}, loop.delay_s) == 0);
    forecast.cycle = describing_function_cycle(loop);
    constexpr double kRelayFrom = 4;  // linear strips
    if (!forecast.cycle || forecast.cycle->amplitude_m <= kRelayFrom * loop.force_limit_N / K)
        return forecast;
    if (const auto relay = relay_orbit(loop, *forecast.cycle)) {
        forecast.cycle = relay;
        forecast.predictor = CyclePredictor::kRelayOrbit;
    }
    return forecast;
}

std::optional<double> press_fold_N(const PressedLoop& given) {
    PressedLoop loop = given;
    loop.press_N = loop.force_limit_N / 2;
    const PressForecast forecast = forecast_press(loop);
    if (!forecast.cycle) return std::nullopt;
    const bool relay = forecast.predictor == CyclePredictor::kRelayOrbit;
    const double through_N = loop.force_limit_N * (1 + loop.hand.stiffness_N_per_m / loop.stiffness_N_per_m);
    return std::max(through_N, relay ? relay_fold_N(loop, *forecast.cycle) : harmonic_fold_N(loop));
}

NeededDamping needed_damping(const DelayedLoop& loop, double delay_s) {
    require_meaningful(loop);
    require_delay(delay_s);
    const double m = loop.hand.mass_kg, k = loop.hand.stiffness_N_per_m, K = loop.stiffness_N_per_m;
    const auto excess = [&](double w) { return m * w * w - k - K * portable::cos(w * delay_s); };
    const double last = std::sqrt((k + K) / m) * (1 + 1e-12);
    constexpr double kPerTurn = 64;
    constexpr double kMostTurnedForFriction_rad = 1e6;
    if (last * delay_s > kMostTurnedForFriction_rad) {
        throw Error(ExitCode::kUsage,
                    "stability: with friction, the product of delay and frequency must stay below 1e6 rad: "
                    "give a shorter delay");
    }
    const double steps = std::ceil(kPerTurn * (1 + last * delay_s));
    NeededDamping most;
    double low = 0;
    for (double i = 1; i <= steps; ++i) {
        const double high = last * i / steps;
        if ((excess(low) > 0) != (excess(high) > 0)) {
            const bool rises = excess(high) > 0;
            const double w =
                zero_between(low, high, [&](double x) { return rises ? excess(x) : -excess(x); });
            const double b = K * portable::sin(w * delay_s) / w;
            if (b > most.damping_Ns_per_m) most = {b, w};
        }
        low = high;
    }
    return most;
}

double friction_threshold_m(const DelayedLoop& loop, double delay_s, double friction_N) {
    const NeededDamping needed = needed_damping(loop, delay_s);
    const double missing = needed.damping_Ns_per_m - loop.hand.damping_Ns_per_m;
    if (!(missing > 0)) return std::numeric_limits<double>::infinity();
    return 4 * friction_N / (kPi * needed.frequency_rad_per_s * missing);
}

double encoder_chatter_m(double stiffness_N_per_m, double critical_stiffness_N_per_m, double encoder_step_m,
                         double friction_N) {
    const double force_step_N = stiffness_N_per_m * encoder_step_m;
    if (stiffness_N_per_m >= critical_stiffness_N_per_m) return std::numeric_limits<double>::infinity();
    if (friction_N >= force_step_N / 2 || !std::isfinite(critical_stiffness_N_per_m)) return 0;
    return 2 * force_step_N / (kPi * critical_stiffness_N_per_m);
}

}  // namespace thimble
