#include "bench/velocity/needle_path.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace thimble {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr std::array kTremorBand_Hz{8.3, 11.1};  // the band of physiological tremor
constexpr double kFirstSample_s = 1;             // jitter shall not lead before the clock's origin

// From 0 to 1 within 0 <= u <= 1, and its slope.
NeedleState minimum_jerk(double u) {
    if (u <= 0) return {0, 0};
    if (u >= 1) return {1, 0};
    return {u * u * u * (10 + u * (6 * u - 15)), 30 * u * u * (1 + u * (u - 2))};
}

}  // namespace

NeedlePath line(double start_m, double velocity_m_per_s) {
    return [=](double time_s) { return NeedleState{start_m + velocity_m_per_s * time_s, velocity_m_per_s}; };
}

NeedlePath oscillation(double centre_m, double amplitude_m, double frequency_Hz) {
    const double rate = kTurn * frequency_Hz;
    return [=](double time_s) {
        return NeedleState{centre_m + amplitude_m * std::sin(rate * time_s),
                           amplitude_m * rate * std::cos(rate * time_s)};
    };
}

NeedlePath reach(const Reach& reach) {
    return [r = reach](double time_s) {
        const NeedleState in = minimum_jerk((time_s - r.rest_s) / r.move_s);
        const NeedleState out = minimum_jerk((time_s - r.rest_s - r.move_s - r.hold_s) / r.move_s);
        NeedleState state{r.start_m + r.depth_m * (in.position_m - out.position_m),
                          r.depth_m / r.move_s * (in.velocity_m_per_s - out.velocity_m_per_s)};
        for (const double frequency_Hz : kTremorBand_Hz) {
            const NeedleState shake = oscillation(0, r.tremor_m, frequency_Hz)(time_s);
            state.position_m += shake.position_m;
            state.velocity_m_per_s += shake.velocity_m_per_s;
        }
        return state;
    };
}

SampledNeedle sample(const NeedlePath& path, double duration_s, const NeedleEncoder& encoder,
                     RandomStream& random) {
    SampledNeedle needle;
    const auto count = static_cast<std::int64_t>(duration_s / to_seconds(encoder.period));
    const double jitter_s = to_seconds(encoder.jitter);
    for (std::int64_t i = 0; i <= count; ++i) {
        const Duration due = i * encoder.period + from_seconds(random.uniform(-jitter_s, jitter_s));
        const NeedleState state = path(to_seconds(due));
        needle.times.push_back(SessionTime{from_seconds(kFirstSample_s) + due});
        needle.truth.push_back(state);
        needle.encoder_m.push_back(std::round(state.position_m / encoder.quantum_m) * encoder.quantum_m);
    }
    return needle;
}

}  // namespace thimble
