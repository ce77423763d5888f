#include "bench/problems.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/math/portable.hpp"

namespace thimble {

namespace {

using Needle = std::function<double(double)>;

constexpr double kMs = 1e-3;

// From 0 to 1 with the least jerk.
double glide(double fraction) {
    if (fraction <= 0) return 0;
    if (fraction >= 1) return 1;
    return fraction * fraction * fraction * (10 + fraction * (6 * fraction - 15));
}

struct Move {
    double start_s, duration_s, to_m;
};

// One gliding move after the other, rest between them.
Needle glides(double from_m, std::vector<Move> moves) {
    return [from_m, moves = std::move(moves)](double t_s) {
        double at_m = from_m;
        double left_m = from_m;
        for (const Move& move : moves) {
            at_m += (move.to_m - left_m) * glide((t_s - move.start_s) / move.duration_s);
            left_m = move.to_m;
        }
        return at_m;
    };
}

// In, hold and out again at the given greatest speed (a glide's is 15/8 of its mean).
Needle in_and_out(double depth_m, double speed_m_per_s, double hold_s) {
    const double move_s = 1.875 * depth_m / speed_m_per_s;
    return glides(0, {{0, move_s, depth_m}, {move_s + hold_s, move_s, 0}});
}

double turn(double frequency_Hz, double t_s) {
    return portable::sin(2 * std::numbers::pi * frequency_Hz * t_s);
}

Needle quantised(Needle needle, double quantum_m) {
    return [needle = std::move(needle), quantum_m](double t_s) {
        return quantum_m * std::round(needle(t_s) / quantum_m);
    };
}

// Corners at whole multiples of `corner_s`.
Needle polygon(std::vector<double> corners_m, double corner_s) {
    return [corners_m = std::move(corners_m), corner_s](double t_s) {
        const double place = t_s / corner_s;
        const auto i = static_cast<std::size_t>(place);
        if (i + 1 >= corners_m.size()) return corners_m.back();
        return corners_m[i] + (corners_m[i + 1] - corners_m[i]) * (place - static_cast<double>(i));
    };
}

// Dips that reach the resting surface exactly, 1 nm and 1 um deep, with vertices at samples.
double grazing(double t_s) {
    constexpr double kRest_m = 0.020;
    constexpr std::array<double, 3> kVertex_s{0.25, 0.75, 1.25};
    constexpr std::array<double, 3> kBeyond_m{0, 1e-9, 1e-6};
    const auto dip = static_cast<std::size_t>(std::fmin(2, std::floor(t_s / 0.5)));
    const double off_s = std::round((t_s - kVertex_s[dip]) / kMs) * kMs;
    return kRest_m + (kBeyond_m[dip] - 0.05 * off_s * off_s);
}

TissueParameters tissue(double mass_kg, double stiffness_N_per_m, double damping_Ns_per_m,
                        double drag_Ns_per_m, double puncture_force_N) {
    TissueParameters p;
    p.mass_kg = mass_kg;
    p.stiffness_N_per_m = stiffness_N_per_m;
    p.damping_Ns_per_m = damping_Ns_per_m;
    p.drag_Ns_per_m = drag_Ns_per_m;
    p.puncture_force_N = puncture_force_N;
    return p;
}

std::vector<Problem> all_problems() {
    const TissueParameters paper;
    const Needle in_and_back = glides(0.010, {{0, 1, 0.060}, {1.5, 1, 0.010}});
    const Needle in_and_back_sooner = glides(0.010, {{0, 1, 0.060}, {1.4, 1, 0.010}});
    // 9 N/m and 5.5 + 0.5 N s/m at 1 kg are critically damped exactly, with the needle in it.
    const auto near_critical = [](double factor) { return tissue(1, 9 * factor, 5.5, 0.5, 0.1); };
    const TissueParameters ringing = tissue(0.05, 200, 0.3, 0.1, 0.5);
    const auto tremor = [in = glides(0, {{0, 0.8, 0.07}})](double t_s) {
        return in(t_s) + 1e-3 * glide((t_s - 0.8) / 0.2) * turn(8, t_s);
    };
    const auto tremble = [](double t_s) { return 0.0201 + 3e-4 * turn(9, t_s); };
    return {
        {"press", "press and let go, no puncture", paper, 3, kMs,
         glides(0.015, {{0, 1.5, 0.024}, {1.5, 1.2, 0.012}})},
        {"slow_press", "press at some 10 mm/s until puncture", paper, 6, kMs, glides(0.018, {{0, 8, 0.064}})},
        {"insert_30mm_s", "insertion, hold, withdrawal at 30 mm/s", paper, 5.6, kMs,
         in_and_out(0.040, 0.030, 0.5)},
        {"insert_100mm_s", "at 100 mm/s", paper, 4.4, kMs, in_and_out(0.1, 0.1, 0.5)},
        {"insert_300mm_s", "at 300 mm/s", paper, 2, kMs, in_and_out(0.1, 0.3, 0.5)},
        {"pull_out", "out of a stretched surface, which returns to the waiting needle", paper, 7, kMs,
         glides(0.018, {{0, 6, 0.058}, {4.5, 0.6, 0.022}})},
        {"tremor", "8 Hz, 1 mm in the tissue", paper, 3, kMs, tremor},
        {"critical", "critically damped beneath the surface", near_critical(1), 3.5, kMs, in_and_back},
        {"critical_+1e-12", "stiffer by 1e-12 of it", near_critical(1 + 1e-12), 3.5, kMs, in_and_back},
        {"critical_-1e-12", "softer by 1e-12 of it", near_critical(1 - 1e-12), 3.5, kMs, in_and_back},
        {"critical_+1e-8", "stiffer by 1e-8 of it", near_critical(1 + 1e-8), 3.5, kMs, in_and_back},
        {"critical_-1e-8", "softer by 1e-8 of it", near_critical(1 - 1e-8), 3.5, kMs, in_and_back},
        {"underdamped", "rings at 10 Hz, damping ratio 0.05", ringing, 3, kMs,
         glides(0.010, {{0, 0.8, 0.050}, {1.2, 0.8, 0.005}})},
        {"massless", "1e-12 kg", tissue(1e-12, 2, 5, 0.7, 0.1), 3, kMs, in_and_back_sooner},
        {"heavy", "1e6 kg", tissue(1e6, 2, 5, 0.7, 0.1), 3, kMs, in_and_back_sooner},
        {"wall", "1e6 N/m on 50 g, rings at 712 Hz", tissue(0.05, 1e6, 20, 2, 200), 1, kMs,
         glides(0.0198, {{0, 0.4, 0.0206}, {0.5, 0.3, 0.0195}})},
        // Needles with corners: the claims of docs/speed.md were not made for these.
        {"quantised", "read by a 0.03 mm encoder", paper, 2, kMs, quantised(in_and_out(0.1, 0.3, 0.5), 3e-5)},
        {"coarse", "a recording of one sample in 2 s", paper, 20, 2,
         polygon({0.005, 0.015, 0.045, 0.09, 0.09, 0.05, 0.025, 0.028, 0.028, 0.005, 0.005}, 2)},
        // In these two the number of transitions depends on the last bit.
        {"grazing", "touches the surface by 0, 1 nm and 1 um", ringing, 1.5, kMs, &grazing},
        {"chatter", "a quantised needle trembles at the surface", ringing, 2, kMs, quantised(tremble, 3e-5)},
    };
}

}  // namespace

std::vector<double> Problem::needle_samples_m() const {
    const auto steps = static_cast<std::size_t>(std::round(duration_s / step_s));
    std::vector<double> samples_m(steps + 1);
    for (std::size_t i = 0; i <= steps; ++i) samples_m[i] = needle_m(static_cast<double>(i) * step_s);
    return samples_m;
}

const std::vector<Problem>& problems() {
    static const std::vector<Problem> list = all_problems();
    return list;
}

const Problem& problem_named(std::string_view name) {
    std::string names;
    for (const Problem& problem : problems()) {
        if (problem.name == name) return problem;
        names += fmt::format("{}{}", names.empty() ? "" : ", ", problem.name);
    }
    throw Error(ExitCode::kUsage, "there is no problem \"{}\": take some of {}", name, names);
}

}  // namespace thimble
