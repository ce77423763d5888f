#include <cmath>
#include <string>

#include "common/error.hpp"
#include "stability/circle_count.hpp"

namespace thimble {
namespace {

constexpr double kShortestStep_s = 1e-9, kLongestStep_s = 1e3, kMostSteps = 1e8;
constexpr double kSameTime = 1e-12;  // of T/h: rounding of decimals, not a part of a step

// Response of velocity (S) and position (Q) to a unit acceleration, as in slave_sim/second_order.hpp.
struct StepAnswer {
    Precise velocity, position;
};

// Powers of t: no digits are lost however soft the spring is.
StepAnswer by_series(const Precise& a, const Precise& w2, const Precise& t) {
    const Precise at = a * t, wt2 = w2 * t * t;
    Precise before = 0, term = t;
    StepAnswer sum{t, t * t / 2};
    for (int n = 2; n < 60; ++n) {
        const Precise next = -(at * (n - 1) * term + wt2 * before) / (n * (n - 1));
        before = term;
        term = next;
        sum.velocity += term;
        sum.position += term * t / (n + 1);
    }
    return sum;
}

StepAnswer by_modes(const Precise& a, const Precise& w2, const Precise& t) {
    const Precise half = a / 2, discriminant = half * half - w2;
    if (discriminant < 0) {
        const Precise w = sqrt(Precise(-discriminant)), faded = exp(Precise(-half * t));
        const Precise sine = sin(Precise(w * t)) / w;
        return {faded * sine, (1 - faded * (cos(Precise(w * t)) + half * sine)) / w2};
    }
    const Precise root = sqrt(discriminant), fast = half + root, slow = w2 / fast;
    const Precise apart = 2 * root * t;
    const Precise velocity =
        exp(Precise(-slow * t)) * (apart > 0 ? Precise(-expm1(Precise(-apart)) / (2 * root)) : t);
    const Precise held = slow > 0 ? Precise(-expm1(Precise(-slow * t)) / slow) : t;
    return {velocity, (held - velocity) / fast};
}

StepAnswer answer_after(const Precise& a, const Precise& w2, const Precise& t) {
    return a * t <= 1 && w2 * t * t <= 1 ? by_series(a, w2, t) : by_modes(a, w2, t);
}

// Two numbers of a state: position and velocity.
struct PreciseState {
    Precise x, v;
};

void require_sampled(const SampledLoop& loop) {
    require_meaningful(DelayedLoop{loop.hand, loop.stiffness_N_per_m, 0});
    require_delay(loop.delay_s);
    const bool step = loop.step_s >= kShortestStep_s && loop.step_s <= kLongestStep_s;
    if (step && loop.delay_s / loop.step_s <= kMostSteps) return;
    throw Error(ExitCode::kUsage,
                step ? "stability: the delay must not be more than 1e8 steps; give a longer step"
                     : "stability: a step must be 1e-9 to 1e3 s, not " + std::to_string(loop.step_s));
}

}  // namespace

WholeSteps whole_steps(const SampledLoop& loop) {
    require_sampled(loop);
    const double ratio = loop.delay_s / loop.step_s, nearest = std::round(ratio);
    if (std::abs(ratio - nearest) <= kSameTime * std::max(1.0, ratio)) return {nearest, 0};
    const double count = std::floor(ratio);
    return {count, Precise(loop.delay_s) - Precise(count) * Precise(loop.step_s)};
}

PulsePolynomial<Precise> pulse_polynomial(const SampledLoop& loop) {
    const Precise m(loop.hand.mass_kg), h(loop.step_s);
    const Precise a = loop.hand.damping_Ns_per_m / m, w2 = loop.hand.stiffness_N_per_m / m;
    const auto [count, rest] = whole_steps(loop);
    const StepAnswer whole = answer_after(a, w2, h), early = answer_after(a, w2, Precise(h - rest));
    const Precise phi22 = 1 - w2 * whole.position - a * whole.velocity;
    // Numerator of C (zI - Phi)^-1 Gamma: Gamma_x z + (Phi12 Gamma_v - Phi22 Gamma_x).
    const auto constant = [&](const PreciseState& g) { return Precise(whole.velocity * g.v - phi22 * g.x); };
    const PreciseState gam0{early.position / m, early.velocity / m};
    PulsePolynomial<Precise> p;
    p.hand = {exp(Precise(-a * h)), -(1 + phi22 - w2 * whole.position), Precise(1)};
    p.gain = Precise(loop.stiffness_N_per_m);
    p.power = count;
    p.feedback = {constant(gam0), gam0.x, Precise(0)};
    if (rest == 0) return p;
    // Gam1 = e^(A (h - tau')) Gam(tau') is what the whole step has and the first part of it has not.
    const PreciseState gam1{whole.position / m - gam0.x, whole.velocity / m - gam0.v};
    p.power = count + 1;
    p.feedback = {constant(gam1), constant(gam0) + gam1.x, gam0.x};
    return p;
}

PulsePolynomial<double> in_doubles(const PulsePolynomial<Precise>& p) {
    PulsePolynomial<double> q;
    q.power = p.power;
    for (std::size_t i = 0; i < p.hand.size(); ++i) {
        q.hand[i] = to_double(p.hand[i]);
        q.feedback[i] = to_double(p.feedback[i]);
    }
    q.gain = to_double(p.gain);
    return q;
}

}  // namespace thimble
