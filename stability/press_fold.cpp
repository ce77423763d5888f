// Where pressing harder ends the limit cycle.
#include <algorithm>
#include <optional>

#include "stability/limit_cycle.hpp"

namespace thimble {
namespace {

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
        if (at_N > 100 * from_N) break;  // without end
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

std::optional<double> press_fold_N(const PressedLoop& given) {
    PressedLoop loop = given;
    loop.press_N = loop.force_limit_N / 2;
    const PressForecast forecast = forecast_press(loop);
    if (!forecast.cycle) return std::nullopt;
    const bool relay = forecast.predictor == CyclePredictor::kRelayOrbit;
    const double through_N = loop.force_limit_N * (1 + loop.hand.stiffness_N_per_m / loop.stiffness_N_per_m);
    return std::max(through_N, relay ? relay_fold_N(loop, *forecast.cycle) : harmonic_fold_N(loop));
}

}  // namespace thimble
