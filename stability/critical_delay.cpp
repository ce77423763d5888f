#include "stability/critical_delay.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "common/error.hpp"
#include "stability/delayed_loop.hpp"
#include "stability/precise_number.hpp"

namespace thimble {

namespace {

// Coefficients from the constant on.
using Polynomial = std::vector<Precise>;

Precise value_of(const Polynomial& p, const Precise& x) {
    Precise sum = 0;
    for (std::size_t i = p.size(); i-- > 0;) sum = sum * x + p[i];
    return sum;
}

Precise sign_change(const Polynomial& p, Precise low, Precise high) {
    constexpr int kHalvings = 100;
    const bool rises = value_of(p, high) > 0;
    for (int i = 0; i < kHalvings; ++i) {
        const Precise middle = (low + high) / 2;
        ((value_of(p, middle) > 0) == rises ? high : low) = middle;
    }
    return (low + high) / 2;
}

// Where p changes its sign between 0 and `last`: once at most between two such places of its derivative.
std::vector<Precise> sign_changes(const Polynomial& p, const Precise& last) {
    std::vector<Precise> found;
    if (p.size() < 2) return found;
    Polynomial slope;
    slope.reserve(p.size() - 1);
    for (std::size_t i = 1; i < p.size(); ++i) slope.push_back(p[i] * static_cast<int>(i));
    std::vector<Precise> ends = sign_changes(slope, last);
    ends.push_back(last);
    Precise from = 0;
    for (const Precise& to : ends) {
        if ((value_of(p, from) > 0) != (value_of(p, to) > 0)) found.push_back(sign_change(p, from, to));
        from = to;
    }
    return found;
}

// D(s) = numerator / denominator, coefficients from the constant on.
struct HandleRatio {
    std::array<Precise, 5> numerator;
    std::array<Precise, 3> denominator;
};

HandleRatio ratio_of(const HeldHandle& h) {
    const Precise md(h.handle_mass_kg), bd(h.handle_damping_Ns_per_m), kg(h.grip_stiffness_N_per_m);
    const Precise bg(h.grip_damping_Ns_per_m), ma(h.arm_mass_kg), ba(h.arm_damping_Ns_per_m),
        ka(h.arm_stiffness_N_per_m);
    const std::array<Precise, 3> d{kg + ka, bg + ba, ma};
    return {{kg * ka, kg * ba + bg * ka + bd * d[0], kg * ma + bg * ba + md * d[0] + bd * d[1],
             bg * ma + md * d[1] + bd * d[2], md * d[2]},
            d};
}

ComplexOf<Precise> numerator_at(const HandleRatio& r, const Precise& w) {
    const Precise u = w * w;
    return {r.numerator[0] + u * (u * r.numerator[4] - r.numerator[2]),
            w * (r.numerator[1] - u * r.numerator[3])};
}

ComplexOf<Precise> denominator_at(const HandleRatio& r, const Precise& w) {
    return {r.denominator[0] - w * w * r.denominator[2], w * r.denominator[1]};
}

// |numerator|^2 - K^2 |denominator|^2 in u = w^2.
Polynomial magnitude_excess(const HandleRatio& r, const Precise& loop) {
    const auto& n = r.numerator;
    const auto& d = r.denominator;
    const Precise square = loop * loop;
    return {n[0] * n[0] - square * d[0] * d[0],
            n[1] * n[1] - 2 * n[0] * n[2] - square * (d[1] * d[1] - 2 * d[0] * d[2]),
            n[2] * n[2] + 2 * n[0] * n[4] - 2 * n[1] * n[3] - square * d[2] * d[2],
            n[3] * n[3] - 2 * n[2] * n[4], n[4] * n[4]};
}

Precise last_root_bound(const Polynomial& p) {
    Precise sum = 0;
    for (const Precise& coefficient : p) sum += abs(coefficient);
    const Precise bound = sum / p.back();
    return bound > 1 ? bound : Precise(1);
}

void require_meaningful(const HeldHandle& h) {
    const bool masses = h.handle_mass_kg > 0 && h.arm_mass_kg > 0;
    const double sum = h.handle_mass_kg + h.handle_damping_Ns_per_m + h.grip_stiffness_N_per_m +
                       h.grip_damping_Ns_per_m + h.arm_mass_kg + h.arm_damping_Ns_per_m +
                       h.arm_stiffness_N_per_m;
    const bool rest = h.handle_damping_Ns_per_m >= 0 && h.grip_stiffness_N_per_m >= 0 &&
                      h.grip_damping_Ns_per_m >= 0 && h.arm_damping_Ns_per_m >= 0 &&
                      h.arm_stiffness_N_per_m >= 0;
    if (masses && rest && std::isfinite(sum)) return;
    throw Error(
        ExitCode::kUsage,
        "stability: a handle in a hand needs masses above 0 kg, and damping and stiffness of 0 or more");
}

}  // namespace

CriticalPoint critical_point(const HeldMass& held, double loop_stiffness_N_per_m) {
    return critical_point(DelayedLoop{held, loop_stiffness_N_per_m, 0});
}

CriticalPoint critical_point(const HeldHandle& held, double loop_stiffness_N_per_m) {
    require_meaningful(held);
    require_meaningful(DelayedLoop{{held.handle_mass_kg, 0, 0}, loop_stiffness_N_per_m, 0});
    const HandleRatio ratio = ratio_of(held);
    const Precise K(loop_stiffness_N_per_m);
    const Polynomial excess = magnitude_excess(ratio, K);
    CriticalPoint first{std::numeric_limits<double>::infinity(), 0};
    for (const Precise& square : sign_changes(excess, last_root_bound(excess))) {
        const Precise w = sqrt(square);
        const ComplexOf<Precise> n = numerator_at(ratio, w);
        // e^(jwT) = -K / D(jw).
        const ComplexOf<Precise> turn = denominator_at(ratio, w) * ComplexOf<Precise>{-n.re, n.im};
        const Precise angle = atan2(turn.im, turn.re);
        const double delay_s = to_double((angle < 0 ? Precise(angle + 2 * pi_of<Precise>()) : angle) / w);
        if (delay_s < first.delay_s) first = {delay_s, to_double(w)};
    }
    return first;
}

double critical_delay_s(const HeldMass& held, double loop_stiffness_N_per_m) {
    return critical_point(held, loop_stiffness_N_per_m).delay_s;
}

double critical_delay_s(const HeldHandle& held, double loop_stiffness_N_per_m) {
    return critical_point(held, loop_stiffness_N_per_m).delay_s;
}

}  // namespace thimble
