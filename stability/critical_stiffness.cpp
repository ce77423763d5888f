// Critical gains at a given delay: of the force loop, and of a person's own loop.
#include <limits>
#include <vector>

#include "common/error.hpp"
#include "stability/delayed_loop.hpp"
#include "stability/precise_number.hpp"

namespace thimble {
namespace {

constexpr int kMostHalvings = 140;

struct PreciseHand {
    Precise m, b, k;

    explicit PreciseHand(const HeldMass& held)
        : m(held.mass_kg), b(held.damping_Ns_per_m), k(held.stiffness_N_per_m) {}
    Precise phase(const Precise& w) const { return atan2(Precise(b * w), Precise(k - m * w * w)); }
    Precise magnitude(const Precise& w) const {
        const Precise real = k - m * w * w, imaginary = b * w;
        return sqrt(Precise(real * real + imaginary * imaginary));
    }
};

// Where a rising function reaches zero: halving, then secants, which are believed where the sign changes on both sides.
template <class Function>
Precise rising_root(Precise low, Precise high, const Function& excess) {
    constexpr int kHalvingsAtATime = 24, kSecants = 6;
    const Precise close(1e-22);
    for (int i = 0; i < kMostHalvings; ++i) {
        const Precise middle = (low + high) / 2;
        (excess(middle) > 0 ? high : low) = middle;
        if (high - low <= low * close) break;
        if (i % kHalvingsAtATime != kHalvingsAtATime - 1) continue;
        Precise before = low, at = high, before_excess = excess(before);
        for (int step = 0; step < kSecants && at != before; ++step) {
            const Precise at_excess = excess(at);
            if (at_excess == before_excess) break;
            const Precise next = at - at_excess * (at - before) / (at_excess - before_excess);
            before = at;
            before_excess = at_excess;
            at = next;
        }
        const bool inside = at > low && at < high;
        if (inside && excess(at * (1 - close)) <= 0 && excess(at * (1 + close)) >= 0) return at;
    }
    return (low + high) / 2;
}

// Candidates are the crossings n = 0, 1, ... of a gain that falls and then rises with frequency, from `turn` on: the last
// one before it and the first one behind it. `turns` is the rising phase at a frequency, in odd multiples of pi.
std::vector<long> around(const Precise& turns) {
    const long last = static_cast<long>(to_double(floor(turns)));
    if (last < 0) return {0};
    return {last, last + 1};
}

// Without damping P is real: crossings are where it has the right sign, on its way through resonance none if that is at once.
CriticalStiffness undamped(const PreciseHand& hand, const Precise& delay) {
    const Precise pi = pi_of<Precise>(), resonance = sqrt(Precise(hand.k / hand.m));
    const Precise half_turns = resonance * delay / pi, whole = floor(half_turns);
    const bool odd = to_double(whole / 2 - floor(Precise(whole / 2))) > 0;
    // Between an even and an odd number of half turns the least stiffness feeds the resonance.
    if (!odd) return {0, to_double(resonance)};
    const Precise below = whole * pi / delay, above = (whole + 1) * pi / delay;
    const Precise w = hand.magnitude(below) <= hand.magnitude(above) ? below : above;
    return {to_double(hand.magnitude(w)), to_double(w)};
}

}  // namespace

CriticalStiffness critical_stiffness(const HeldMass& held, double delay_s) {
    require_meaningful(held);
    require_delay(delay_s);
    if (delay_s == 0) return {std::numeric_limits<double>::infinity(), 0};
    const PreciseHand hand(held);
    const Precise T(delay_s), pi = pi_of<Precise>();
    if (hand.b == 0) return undamped(hand, T);
    const auto psi = [&](const Precise& w) { return Precise(hand.phase(w) + w * T); };
    const Precise turn = (2 * hand.m * hand.k - hand.b * hand.b) / (2 * hand.m * hand.m);
    const Precise w_turn = turn > 0 ? Precise(sqrt(turn)) : Precise(0);
    Precise least = -1, frequency = 0;
    for (const long n : around((psi(w_turn) / pi - 1) / 2)) {
        const Precise goal = (2 * n + 1) * pi;
        const Precise w = rising_root(0, goal / T, [&](const Precise& x) { return Precise(psi(x) - goal); });
        const Precise size = hand.magnitude(w);
        if (least >= 0 && size >= least) continue;
        least = size;
        frequency = w;
    }
    return {to_double(least), to_double(frequency)};
}

// w |P(jw)| may dip behind the hand's resonance: between the zeros of d(w^2 |P|^2) / d(w^2) = 3 m^2 u^2 + 2 (b^2 - 2mk) u + k^2.
PerceptualLimit perceptual_limit(const HeldMass& held, double lag_s) {
    require_meaningful(held);
    require_delay(lag_s);
    const PreciseHand hand(held);
    const Precise pi = pi_of<Precise>(), lag(lag_s);
    if (hand.k == 0 || hand.b == 0) {
        throw Error(ExitCode::kUsage,
                    "stability: a hand that follows its reference needs stiffness and damping above 0");
    }
    const auto psi = [&](const Precise& w) { return Precise(pi / 2 + hand.phase(w) + w * lag); };
    const Precise half = hand.b * hand.b - 2 * hand.m * hand.k, mm = hand.m * hand.m;
    const Precise discriminant = half * half - 3 * mm * hand.k * hand.k;
    std::vector<long> candidates{0};
    if (half < 0 && discriminant > 0 && lag > 0) {
        const Precise dip = sqrt(Precise((sqrt(discriminant) - half) / (3 * mm)));
        const std::vector<long> near_dip = around((psi(dip) / pi - 1) / 2);
        candidates.insert(candidates.end(), near_dip.begin(), near_dip.end());
    }
    Precise least = -1, frequency = 0;
    for (const long n : candidates) {
        const Precise goal = (2 * n + 1) * pi;
        // Without lag the phase reaches pi at the resonance.
        const Precise top = lag > 0 && n > 0 ? Precise(goal / lag) : Precise(sqrt(Precise(hand.k / hand.m)));
        const Precise w = rising_root(0, top, [&](const Precise& x) { return Precise(psi(x) - goal); });
        const Precise gain = w * hand.magnitude(w) / hand.k;
        if (least >= 0 && gain >= least) continue;
        least = gain;
        frequency = w;
    }
    return {to_double(least), to_double(frequency)};
}

}  // namespace thimble
