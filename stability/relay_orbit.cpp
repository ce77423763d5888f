// The exact periodic orbit of a hand under a force that is either zero or its limit.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "slave_sim/second_order.hpp"
#include "stability/limit_cycle.hpp"

namespace thimble {
namespace {

struct HandState {
    double x_m = 0, v_m_per_s = 0;
};

class PulsedHand {
  public:
    explicit PulsedHand(const PressedLoop& loop)
        : loop_(loop),
          hand_(loop.hand.mass_kg, loop.hand.damping_Ns_per_m, loop.hand.stiffness_N_per_m),
          half_strip_m_(loop.force_limit_N / loop.stiffness_N_per_m / 2) {}

    HandState after(const HandState& s, double force_N, double duration_s) const {
        const Propagator p = hand_.propagator(duration_s);
        const double a = hand_.acceleration(force_N, s.x_m, s.v_m_per_s);
        return {s.x_m + p.moved_m(s.v_m_per_s, a), p.velocity_after_m_per_s(s.v_m_per_s, a)};
    }
    double pushed_N() const { return loop_.press_N - loop_.force_limit_N; }
    double free_N() const { return loop_.press_N; }

    // The state at the beginning of the pulse that comes back after one period: (1 - M) s = c.
    HandState periodic(double period_s, double duty) const {
        const auto round = [&](const HandState& s, double on_N, double off_N) {
            return after(after(s, on_N, duty * period_s), off_N, (1 - duty) * period_s);
        };
        const HandState c = round({}, pushed_N(), free_N()), mx = round({1, 0}, 0, 0),
                        mv = round({0, 1}, 0, 0);
        const double a = 1 - mx.x_m, b = -mv.x_m, d = -mx.v_m_per_s, e = 1 - mv.v_m_per_s;
        const double determinant = a * e - b * d;
        return {(e * c.x_m - b * c.v_m_per_s) / determinant, (a * c.v_m_per_s - d * c.x_m) / determinant};
    }

    HandState at(const HandState& start, double period_s, double duty, double time_s) const {
        const double t = time_s - period_s * std::floor(time_s / period_s);
        if (t <= duty * period_s) return after(start, pushed_N(), t);
        return after(after(start, pushed_N(), duty * period_s), free_N(), t - duty * period_s);
    }

    // How far p is from the switching place where the pulse must have been caused, T before its edges.
    std::array<double, 2> misses(double period_s, double duty) const {
        const HandState start = periodic(period_s, duty);
        return {at(start, period_s, duty, -loop_.delay_s).x_m - half_strip_m_,
                at(start, period_s, duty, duty * period_s - loop_.delay_s).x_m - half_strip_m_};
    }

    double half_strip_m() const { return half_strip_m_; }

  private:
    PressedLoop loop_;
    SecondOrder hand_;
    double half_strip_m_;
};

struct PeriodAndDuty {
    double period_s, duty;
};

bool possible(const PeriodAndDuty& x) {
    return std::isfinite(x.period_s) && x.period_s > 0 && x.duty > 0.001 && x.duty < 0.999;
}

std::optional<PeriodAndDuty> solved(const PulsedHand& hand, PeriodAndDuty x) {
    constexpr int kSteps = 60;
    constexpr double kNudge = 1e-6, kDone = 1e-13, kLongest = 0.1;
    for (int i = 0; i < kSteps; ++i) {
        const auto f = hand.misses(x.period_s, x.duty);
        const auto by_period = hand.misses(x.period_s * (1 + kNudge), x.duty);
        const auto by_duty = hand.misses(x.period_s, x.duty + kNudge);
        const double a = (by_period[0] - f[0]) / kNudge, b = (by_duty[0] - f[0]) / kNudge;
        const double c = (by_period[1] - f[1]) / kNudge, d = (by_duty[1] - f[1]) / kNudge;
        const double determinant = a * d - b * c;
        double stretch = -(d * f[0] - b * f[1]) / determinant, widen = -(a * f[1] - c * f[0]) / determinant;
        const double size = std::abs(stretch) + std::abs(widen);
        if (size > kLongest) {
            stretch *= kLongest / size;
            widen *= kLongest / size;
        }
        x = {x.period_s * (1 + stretch), x.duty + widen};
        if (!possible(x)) return std::nullopt;
        if (size < kDone) return x;
    }
    // Rounding of the nudges ends Newton a little above kDone.
    const auto f = hand.misses(x.period_s, x.duty);
    if (std::abs(f[0]) + std::abs(f[1]) > 1e-9 * hand.half_strip_m()) return std::nullopt;
    return x;
}

struct Extremes {
    double lowest_m, highest_m;
    int switches;
};

Extremes extremes_of(const PulsedHand& hand, const PeriodAndDuty& x) {
    constexpr int kPoints = 256, kHalvings = 60;
    const HandState start = hand.periodic(x.period_s, x.duty);
    const auto state = [&](double part) { return hand.at(start, x.period_s, x.duty, part * x.period_s); };
    HandState before = start;
    Extremes e{start.x_m, start.x_m, 0};
    for (int i = 1; i <= kPoints; ++i) {
        const HandState now = state(i == kPoints ? 0 : static_cast<double>(i) / kPoints);
        if ((before.x_m > hand.half_strip_m()) != (now.x_m > hand.half_strip_m())) ++e.switches;
        if ((before.v_m_per_s > 0) != (now.v_m_per_s > 0)) {
            double low = static_cast<double>(i - 1) / kPoints, high = static_cast<double>(i) / kPoints;
            for (int halving = 0; halving < kHalvings; ++halving) {
                const double middle = (low + high) / 2;
                ((state(middle).v_m_per_s > 0) == (before.v_m_per_s > 0) ? low : high) = middle;
            }
            const double turned_m = state((low + high) / 2).x_m;
            e.lowest_m = std::min(e.lowest_m, turned_m);
            e.highest_m = std::max(e.highest_m, turned_m);
        }
        before = now;
    }
    return e;
}

}  // namespace

std::optional<LimitCycle> relay_orbit(const PressedLoop& loop, const LimitCycle& guess) {
    const PulsedHand hand(loop);
    // The mean of the force over its limit, from the balance with press and spring.
    const double mean_N = loop.press_N - loop.hand.stiffness_N_per_m * guess.mean_m;
    const PeriodAndDuty start{2 * std::numbers::pi / guess.frequency_rad_per_s, mean_N / loop.force_limit_N};
    if (!possible(start)) return std::nullopt;
    const auto orbit = solved(hand, start);
    if (!orbit) return std::nullopt;
    const Extremes e = extremes_of(hand, *orbit);
    if (e.switches != 2) return std::nullopt;
    return LimitCycle{2 * std::numbers::pi / orbit->period_s,
                      (e.highest_m - e.lowest_m) / 2,
                      (e.highest_m + e.lowest_m) / 2,
                      e.lowest_m,
                      e.highest_m,
                      orbit->duty};
}

}  // namespace thimble
